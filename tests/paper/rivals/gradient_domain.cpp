#include "face_motions.h"
#include "rival.h"

namespace pliant {

namespace {

class GradientDomain final : public Rival {
public:
    explicit GradientDomain(const NormalizedPoses& set)
        : set_(set)
        , fit_(set, default_solver())
    {
        for (const Shape& shape : set.shapes) motions_.push_back(face_motions(set, shape));
    }
    const RivalTraits& traits() const override
    {
        static const RivalTraits traits { "gradient domain", "Xu et al. 2005, Sumner et al. 2005", true, false,
                                          "triangles turn by more than half a turn" };
        return traits;
    }
    Shape blend(const Weights& w) override { return put_together(set_, fit_, w, blend_motions(motions_, w)); }

private:
    const NormalizedPoses& set_;
    CellFit fit_;
    std::vector<std::vector<FaceMotion>> motions_; // of each pose
};

} // namespace

std::unique_ptr<Rival> make_gradient_domain(const NormalizedPoses& set) { return std::make_unique<GradientDomain>(set); }

} // namespace pliant
