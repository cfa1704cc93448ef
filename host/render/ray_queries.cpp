#include "render/ray_queries.hpp"

#include "render/frame_constants.hpp"
#include "render/guarded.hpp"

namespace clarity {

std::vector<rt_hit> RayQueries::trace(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query,
                                      double* device_ms) {
    return guarded(*device_, "tracing rays", [&] {
        std::vector<rt_hit> hits(rays.size());
        if (device_ms) *device_ms = 0;
        if (rays.empty()) return hits;
        const Layout layout = make_layout(prepared.settings, device_->info().cpu);
        bool fresh = false;
        const KernelKind kind = query.count ? KernelKind::counted_rays : KernelKind::rays;
        const KernelSource source =
            assemble_kernel(prepared.settings, layout, kind, features_of(*prepared.scene, prepared.accel->scene),
                            *prepared.accel->plugin, prepared.accel->defines);
        const auto program =
            programs_.get(source, kind, std::string("ray queries with accel ") + prepared.accel->plugin->id, &fresh);
        cl::CommandQueue& queue = device_->queue();
        view_.write(queue, *prepared.scene, make_frame(View(), prepared.settings, layout, *prepared.accel, 0), View());
        const cl::Buffer& in = in_.fit(device_->context(), rays.size() * sizeof(rt_ray));
        const cl::Buffer& out = out_.fit(device_->context(), rays.size() * sizeof(rt_hit));
        queue.enqueueWriteBuffer(in, CL_TRUE, 0, rays.size() * sizeof(rt_ray), rays.data());

        cl::Kernel kernel = program->kernel();
        cl_uint at = 0;
        kernel.setArg(at++, view_.frame());
        const cl_uint first_group = at++;
        kernel.setArg(at++, static_cast<cl_uint>(rays.size()));
        kernel.setArg(at++, static_cast<cl_uint>(query.any_hit));
        kernel.setArg(at++, in);
        kernel.setArg(at++, out);
        view_.bind(*prepared.on_device, kernel, at);
        const size_t per_group = size_t(layout.group_packets()) * layout.lanes;
        // A pace is that of one program on one scene; with it, what is short is one launch.
        if (program != last_program_ || prepared.on_device != last_scene_) launcher_.forget();
        last_program_ = program;
        last_scene_ = prepared.on_device;
        const LaunchTimes times =
            launcher_.run(queue, kernel, first_group, static_cast<unsigned>((rays.size() + per_group - 1) / per_group),
                          layout.local_size(), [] {});
        if (device_ms) *device_ms = times.device_ms;
        queue.enqueueReadBuffer(out, CL_TRUE, 0, hits.size() * sizeof(rt_hit), hits.data());
        return hits;
    });
}

}  // namespace clarity
