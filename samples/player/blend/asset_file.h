// An asset in memory, opened: a .pliant file, or the asset inside a .glb file.
#pragma once

#include <pliant.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace pliant::player {

// A weight of an asset: the name of its layer or pose, its range, the weight to start with. Of layers the range is the one
// that the baker has measured, of averages it is 0 to 1.
struct WeightRange {
    std::string name;
    double low = 0.0, high = 1.0, initial = 0.0;
};

// Owns the bytes and the view into them. Moving it leaves the bytes where they are.
class AssetFile {
public:
    // Reads and checks the file, including its checksums. A GLB file is searched for the asset that `pliant export --embed`
    // put into it. Throws Error (exit code 3).
    explicit AssetFile(const std::string& path);

    const pliant_asset& view() const { return asset_; }
    const std::string& path() const { return path_; }
    const std::vector<std::string>& pose_names() const { return pose_names_; }
    // pose_names() without their common prefix up to a separator ("creature_"), for labels.
    const std::vector<std::string>& short_names() const { return short_names_; }
    const std::vector<WeightRange>& weights() const { return weights_; }
    bool has_layers() const { return asset_.has_layers != 0; }
    std::string counted() const; // "5 poses" or "7 layers"
    std::string letters() const; // of title and names
    std::string title() const;   // the file's name without folder and extension

private:
    void read_weights();

    struct AlignedDelete {
        void operator()(std::byte* bytes) const;
    };

    std::string path_;
    std::unique_ptr<std::byte[], AlignedDelete> blob_;
    pliant_asset asset_ {};
    std::vector<std::string> pose_names_;
    std::vector<std::string> short_names_;
    std::vector<WeightRange> weights_;
};

// Removes the common prefix, up to its last separator, from all names. Returns them unchanged if one would become empty.
std::vector<std::string> without_common_prefix(const std::vector<std::string>& names);

} // namespace pliant::player
