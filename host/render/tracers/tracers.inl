// All tracers: ROW(id) for the function id_tracer(). Of those that suit a device and a scene `auto` takes the last.
ROW(iterative)
ROW(wavefront)
ROW(path)
ROW(aov)
ROW(rays)
ROW(counted_rays)
ROW(all_hits)
ROW(inspect)
