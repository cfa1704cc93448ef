// motion.hpp -- what it costs to follow a scene that moves: which nodes of a pose's tree were there in the pose before.
#pragma once
#include "lab/lab.hpp"
#include "rt_plugin.h"

namespace clarity::lab {

// What a builder of trees did for all poses of a case. Pose k is the mesh k.
struct MotionCosts {
    double nodes = 0;   // of all trees; each got a box for its pose
    double fresh = 0;   // of these, those that the tree of the pose before does not have
    double sorted = 0;  // primitives below each of them
};

// Builds the trees of a case by `plugin`, which builds topologies, and compares each with that of the pose before. What a node
// is decides, and not what the builder says: the primitives below it, and how its children share them. Throws Error.
MotionCosts motion_costs(const rt_plugin& plugin, const Scene& scene);

}  // namespace clarity::lab
