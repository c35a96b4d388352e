#include "panels/shown.h"

namespace pliant::player {

std::vector<Kind> kinds_of(Show show)
{
    switch (show) {
    case Show::elastic: return { Kind::elastic };
    case Show::linear: return { Kind::linear };
    case Show::both: return { Kind::linear, Kind::elastic };
    case Show::three: break;
    }
    return { Kind::linear, Kind::elastic, Kind::unreduced };
}

const char* name_of(Kind kind) { return kind == Kind::linear ? "linear" : kind == Kind::elastic ? "elastic" : "unreduced"; }

} // namespace pliant::player
