// What `pliant bake` and `pliant info` say of a certificate, in the same words.
#pragma once

#include "bake/report.h"
#include "output/page/certificate_facts.h"

#include <string>

namespace pliant {

// "keeps its tolerance: blends at 30 weights are off by ...".
std::string verdict_of(const CertificateFacts& facts);

// "parts drift by at most 0.39 % of the diagonal"; empty for a body in one part.
std::string drift_line(const CertificateFacts& facts);

// "pair: 12 mixtures, relative L2 ...; linear sum ...; 1 more had no shape to compare with".
std::string kind_line(const KindErrors& kind);

} // namespace pliant
