// meshopt.cpp -- EXT_meshopt_compression: views of buffers that meshoptimizer has compressed.
#include "compressed.hpp"
#ifdef CLARITY_HAVE_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace gltf_import {

#ifdef CLARITY_HAVE_MESHOPTIMIZER
std::string decode_meshopt(const Value& extension, std::string_view bytes) {
    const uint64_t count = extension["count"].count(), stride = extension["byteStride"].count();
    const std::string mode = extension["mode"].text(), filter = extension.text("filter", "NONE");
    const bool is_vertices = mode == "ATTRIBUTES", is_triangles = mode == "TRIANGLES";
    if (!is_vertices && !is_triangles && mode != "INDICES") extension["mode"].refuse("'ATTRIBUTES', 'TRIANGLES' or 'INDICES'");
    // The library relies on these.
    if (is_vertices && (stride == 0 || stride > 256 || stride % 4 != 0))
        extension["byteStride"].refuse("a multiple of 4 up to 256");
    if (!is_vertices && stride != 2 && stride != 4) extension["byteStride"].refuse("2 or 4");
    if (is_triangles && count % 3 != 0) extension["count"].refuse("a multiple of 3");
    const bool is_oct = filter == "OCTAHEDRAL", is_quat = filter == "QUATERNION", is_exp = filter == "EXPONENTIAL";
    if (filter != "NONE" && !is_oct && !is_quat && !is_exp)
        extension["filter"].refuse("'NONE', 'OCTAHEDRAL', 'QUATERNION' or 'EXPONENTIAL'");
    if (filter != "NONE" && !is_vertices) extension["filter"].refuse("'NONE' where the mode is " + in_quotes(mode));
    if (is_oct && stride != 4 && stride != 8) extension["byteStride"].refuse("4 or 8 with the filter 'OCTAHEDRAL'");
    if (is_quat && stride != 8) extension["byteStride"].refuse("8 with the filter 'QUATERNION'");
    // The format takes at least 2 bits for 16 bytes, so a larger result is a lie, and its memory is not asked for.
    if (count > (80 * uint64_t(bytes.size()) + 65536) / stride)
        extension["count"].refuse("as many elements as " + std::to_string(bytes.size()) + " compressed bytes can hold");
    std::string out(count * stride, '\0');
    if (count == 0) return out;
    const auto* const from = reinterpret_cast<const unsigned char*>(bytes.data());
    const int code = is_vertices    ? meshopt_decodeVertexBuffer(out.data(), count, stride, from, bytes.size())
                     : is_triangles ? meshopt_decodeIndexBuffer(out.data(), count, stride, from, bytes.size())
                                    : meshopt_decodeIndexSequence(out.data(), count, stride, from, bytes.size());
    if (code != 0)
        extension.refuse("bytes that meshoptimizer cannot decode (code " + std::to_string(code) + ")",
                         std::to_string(count) + " elements: the file is damaged, or its version of the codec is newer");
    if (is_oct) meshopt_decodeFilterOct(out.data(), count, stride);
    if (is_quat) meshopt_decodeFilterQuat(out.data(), count, stride);
    if (is_exp) meshopt_decodeFilterExp(out.data(), count, stride);
    return out;
}
#else
std::string decode_meshopt(const Value& extension, std::string_view) {
    extension.refuse("data compressed with EXT_meshopt_compression",
                     "plain data, because this importer was built without meshoptimizer: install libmeshoptimizer-dev and "
                     "build it again, or export the file without compression");
}
#endif

}  // namespace gltf_import
