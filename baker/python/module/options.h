// Options of Python calls as the baker knows them.
#pragma once

#include "bake/options.h"
#include "input/poses/load_poses.h"

#include <nanobind/nanobind.h>

namespace pliant {

// From a dict with the names of the command line, underscores for hyphens. Numbers have been checked against their ranges in
// Python; a missing one, or None, means the default. Names that there are not raise ValueError.
EnergyOptions energy_options(const nanobind::dict& given);
BakeOptions bake_options(const nanobind::dict& given);

// How poses are checked for an energy.
LoadOptions load_options(const EnergyOptions& options);

} // namespace pliant
