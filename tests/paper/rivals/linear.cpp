#include "face_motions.h"
#include "rival.h"

namespace pliant {

namespace {

class Linear final : public Rival {
public:
    explicit Linear(const NormalizedPoses& set)
        : set_(set)
    {
    }
    const RivalTraits& traits() const override
    {
        static const RivalTraits traits { "linear", "morph targets", true, true, "parts turn" };
        return traits;
    }
    Shape blend(const Weights& w) override { return linear_blend(set_, w); }

private:
    const NormalizedPoses& set_;
};

} // namespace

std::unique_ptr<Rival> make_linear(const NormalizedPoses& set) { return std::make_unique<Linear>(set); }

} // namespace pliant
