// The stage that fits the surrogate energy and chooses the dimension.
#pragma once

#include "bake/report.h"
#include "elastic/average/family.h"
#include "reduced/subspace/adaptive.h"
#include "reduced/surrogate/ghost.h"

#include <memory>

namespace pliant {

// What a fit works on. All must outlive the problem and the FittedModel.
struct FitProblem {
    const NormalizedPoses& set;
    const Energy& energy;
    AverageFamily& family;
    const AverageSource& known;
    const FoundSubspace& found;
    const TimeBudget& budget;
    const WeightDomain& domain;
};

// What the runtime will solve, with the data that it was fitted to. Refers to the averages of `found` and to the energy.
struct FittedModel {
    Subspace subspace; // the leading dimensions of the one found
    TrainingSet training;
    std::unique_ptr<Ghost> ghost; // with a mesh and an energy of its own; else null
    std::unique_ptr<Energy> ghost_energy;
    BlendModel model;
    FitReport report;

    // Shape of the surrogate energy's mesh at the model's mean.
    Shape mean_shape() const;
};

// As few dimensions and elements as keep the tolerance, unless the options fix them. Warns of a surrogate energy that is not
// convex (P4402). Throws Failure (P4401) where the reduced mean does not converge.
FittedModel fit(const FitProblem& problem, const BakeOptions& options, Progress& progress);

} // namespace pliant
