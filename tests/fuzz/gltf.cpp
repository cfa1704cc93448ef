// gltf.cpp -- the bytes of a .gltf or .glb file, through the importer's own code. Data beside the file is not there.
#include <new>

#include "load.hpp"
#include "reading_sink.hpp"
#include "rt_plugin.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    clarity::fuzz::ReadingSink sink;
    try {
        const gltf_import::Document document({reinterpret_cast<const char*>(data), size}, "/nowhere/");
        gltf_import::load_document(document, sink.host(), *sink.sink());
    } catch (const gltf_import::Error& error) {
        sink.check_message(error.what());
    } catch (const rt::Stopped&) {
    } catch (const std::bad_alloc&) {
        // The worker's limit on memory; the importer says so.
    }
    return 0;
}
