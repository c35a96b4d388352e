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
    Shape blend(const Weights& w) override
    {
        std::vector<FaceMotion> blended(set_.triangles.size());
        for (std::size_t i = 0; i < blended.size(); ++i) {
            Eigen::Vector3d turn = Eigen::Vector3d::Zero();
            blended[i].stretch.setZero();
            for (std::size_t k = 0; k < motions_.size(); ++k) {
                turn += w[Eigen::Index(k)] * rotation_vector(motions_[k][i].rotation);
                blended[i].stretch += w[Eigen::Index(k)] * motions_[k][i].stretch;
            }
            blended[i].rotation = rotation_by(turn);
        }
        return put_together(set_, fit_, w, blended);
    }

private:
    const NormalizedPoses& set_;
    CellFit fit_;
    std::vector<std::vector<FaceMotion>> motions_; // of each pose
};

} // namespace

std::unique_ptr<Rival> make_gradient_domain(const NormalizedPoses& set) { return std::make_unique<GradientDomain>(set); }

} // namespace pliant
