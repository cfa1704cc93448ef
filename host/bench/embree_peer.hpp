// embree_peer.hpp -- Embree 3 as a peer.
#pragma once
#include "bench/peer.hpp"

namespace clarity {

std::unique_ptr<PeerScene> build_embree(const PeerMesh& mesh, const std::string& quality, unsigned threads);

}  // namespace clarity
