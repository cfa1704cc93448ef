#include <stdexcept>

#include "render/settings/aov.hpp"
#include "render/tracers/one_kernel.hpp"
#include "render/tracers/tracer.hpp"

namespace clarity {

#define ROW(id) const Tracer& id##_tracer();
#include "render/tracers/tracers.inl"
#undef ROW

Tracer tracer_with(const char* id, void (*smoke)(const Smoke& smoke)) {
    Tracer tracer;
    tracer.id = id;
    tracer.smoke = smoke;
    return tracer;
}

const std::vector<const Tracer*>& tracers() {
#define ROW(id) &id##_tracer(),
    static const std::vector<const Tracer*> all = {
#include "render/tracers/tracers.inl"
    };
#undef ROW
    return all;
}

const std::vector<TracerChoice>& tracer_choices() {
    static const std::vector<TracerChoice> choices = [] {
        std::vector<TracerChoice> chosen;
        for (const Tracer* tracer : tracers())
            if (*tracer->help) chosen.push_back(*tracer);
        return chosen;
    }();
    return choices;
}

const Tracer& find_tracer(const std::string& id) {
    for (const Tracer* tracer : tracers())
        if (id == tracer->id) return *tracer;
    throw std::out_of_range("no tracer `" + id + "`");
}

const Tracer& tracer_of(const Settings& settings) {
    const char* of_aov = find_aov(settings.aov).tracer;
    return find_tracer(of_aov ? of_aov : settings.tracer);
}

const Tracer& automatic_tracer(const DeviceInfo& device, const Scene& scene) {
    const Tracer* chosen = nullptr;
    for (const Tracer* tracer : tracers())
        if (tracer->suits && tracer->suits(device, scene)) chosen = tracer;
    return *chosen;
}

std::unique_ptr<FrameTracer> open_tracer(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program) {
    const Tracer& tracer = find_tracer(program->row.tracer);
    if (tracer.open) return tracer.open(std::move(device), std::move(program));
    return std::make_unique<OneKernel>(std::move(device), std::move(program));
}

}  // namespace clarity
