// Many averages of one family, each followed from its neighbours: a fraction of the cost of following each from the mean.
#pragma once

#include "elastic/average/family.h"

#include <vector>

namespace pliant {

// The averages for `weights`, in their order; `known` ones (the mean at least) are there already. In waves: what earlier
// waves found is interpolated, shapes over weights, and Newton's method goes on from there. Where it goes far, or little is
// known yet, the average is followed along the straight line from the nearest known one instead. On a family that is smooth
// both give a(w), and the neighbours keep all of them on one branch of it where there are several. The result does not
// depend on the number of threads. Errors of the check points are not set.
// Cost: 1 to 10 factorisations each.
std::vector<CheckPoint> sweep(const AverageFamily& family, const std::vector<KnownAverage>& known,
                              const std::vector<Weights>& weights, Progress* progress);

} // namespace pliant
