// curves.hpp -- keys of one number over time, as the host takes them.
#pragma once
#include "../common/keys.hpp"
#include "scene.hpp"

namespace fbx_import {

using Curve = importers::Keys;

// Ticks of the file's clock in a second.
double ticks_of_second(const Document& document);
// The curve of an AnimationCurve (version 7), or of a channel in a take (before). It has no keys if the file has none. Throws
// Broken if they are damaged.
Curve read_curve(const Document& document, const Node& node, double ticks);
Curve read_take_curve(const Document& document, const Node& channel, double ticks);

}  // namespace fbx_import
