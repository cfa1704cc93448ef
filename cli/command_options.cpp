#include "cli/command_options.hpp"

#include "cli/option_groups.hpp"

namespace clarity {

void add_render(CLI::App& app, RenderOptions& render) {
    single(app.add_option("-o,--output", render.output, "Picture to write: .png, .exr or .pfm; #### is the frame's number"))
        ->type_name("OUT");
    single(app.add_option("--frames", render.frames,
                          "Numbers of the frames to render; frame n shows a scene that moves at n / fps seconds"))
        ->type_name("A-B[/STEP]");
    single(app.add_option("--frames-of", render.frames_of,
                          "Only the K-th of N shares of --frames: every N-th frame, from the K-th on (1/N is the first share)"))
        ->type_name("K/N");
    app.add_flag("--skip-existing", render.skip_existing,
                 "Leave out frames that are there already, whole, with a record (OUT as .json) of the same scene and settings");
    single(app.add_option("--checkpoint", render.checkpoint,
                          "Save the samples so far to this file from time to time, and when the picture is interrupted"))
        ->type_name("FILE");
    single(app.add_option("--every", render.every_s, "Seconds between two checkpoints"))
        ->type_name("S")
        ->check(CLI::Range(0.0, 1e6))
        ->capture_default_str();
    single(app.add_option("--resume", render.resume, "Go on with the samples of a checkpoint, and save further ones there"))
        ->type_name("FILE");
    app.add_flag("--verify", render.verify,
                 "SCENE are records of frames (out_*.json): render these frames again, and compare them with their pictures");
    app.add_flag("--mpi", render.mpi,
                 "Share each picture with the other processes that mpirun has started: mpirun -n 4 clarity render ... --mpi");
    single(app.add_option("--fps", render.fps, "Frames a second; default: those of the clip, else 24"))
        ->type_name("F")
        ->check(CLI::Range(1e-3, 1e6));
    add_pose(app, render.pose);
    single(app.add_option("--repeat", render.repeat, "Trace each frame N times for timing, after one warm-up"))->type_name("N");
    single(app.add_option("--crop", render.crop,
                          "Render this part of the picture of --size: its first pixel from the top left, and its size"))
        ->type_name("X,Y,W,H");
    single(
        app.add_option("--error", render.error,
                       "End each picture of `path` when its estimated error is at most this share of its mean light, 0.01 or "
                       "1%; --spp is then the most samples"))
        ->type_name("E")
        ->transform(percent())
        ->check(CLI::Range(1e-6, 1.0));
    single(app.add_option("--time-budget", render.time_budget_s,
                          "End each picture after this time of tracing, in seconds; --spp is then the most samples"))
        ->type_name("S")
        ->check(CLI::Range(1e-3, 1e7));
    single(app.add_option("--reference", render.reference,
                          "A picture of what should come out, .pfm, .exr or .png: --stats has the errors against it, and how "
                          "they fall with the samples"))
        ->type_name("FILE");
    single(app.add_option("--stats", render.stats_file, "Write a JSON of times, rays and sizes; - is stdout"))
        ->type_name("FILE");
    app.add_flag("--watch", render.watch,
                 "Render again whenever a kernel or a scene file named here is saved or a plugin is built again; Ctrl-C ends, "
                 "with the exit code of the last attempt");
}

void add_rays(CLI::App& app, TraceCommand& command) {
    single(app.add_option("--rays", command.rays_file,
                          "Rays, one a line: origin x y z, t_min, direction x y z, t_max; # begins a comment; - is stdin"))
        ->type_name("FILE")
        ->required();
    single(app.add_option("-o,--output", command.output, "Where to write t, prim, instance, u, v of each hit; - is stdout"))
        ->type_name("HITS")
        ->required();
    CLI::Option* const any =
        app.add_flag("--any", command.any_hit, "Ask only whether something is hit between t_min and t_max: 1 or 0 a ray");
    CLI::Option* const all =
        app.add_flag("--all", command.all,
                     "Write all hits of each ray in their order: the ray's number from 0, then what -o says, a line a hit");
    CLI::Option* const count = app.add_flag("--count", command.count, "Write how many hits each ray has, a number a ray");
    single(app.add_option("--mask", command.mask,
                          "The rays hit only instances that share a bit of this number with their mask, 0 to 255"))
        ->check(CLI::Range(0u, RT_SEEN_BY_ALL));
    app.add_flag("--work", command.work,
                 "Write what each ray's packet does, too: nodes visited, boxes tested, primitives tested; --lanes 1 makes "
                 "packets of one ray")
        ->excludes(all)
        ->excludes(count);
    any->excludes(all)->excludes(count);
    all->excludes(count);
}

void add_compare(CLI::App& app, CompareCommand& command) {
    app.add_option("picture", command.test, "The picture: .pfm, .exr or .png")->type_name("A")->required();
    app.add_option("reference", command.reference, "What it should be, of the same size")->type_name("B")->required();
    single(app.add_option("-o,--output", command.output,
                          "Write the signed error as .png: red where A is brighter than B, blue where it is darker"))
        ->type_name("DIFF");
    app.add_flag("--json", command.json, "As JSON");
}

void add_why(CLI::App& app, WhyCommand& why) {
    single(app.add_option("--pixel", why.pixel, "The pixel: its column and row, counted from 0 at the top left"))
        ->type_name("X,Y")
        ->required();
    single(
        app.add_option("--samples", why.samples,
                       "Samples of the pixel that are traced once more, as --spp; default: --spp if that is given, else 1024"))
        ->type_name("K")
        ->check(CLI::Range(2, 65536));
    single(app.add_option("--csv", why.csv_file,
                          "Write the ten brightest paths: each event and each light, with throughput, densities and weight"))
        ->type_name("FILE");
    single(app.add_option(
               "--points", why.points_file,
               "Write the random numbers of all samples, a column for each dimension: pixel, lens, and of each event up to "
               "--depth"))
        ->type_name("FILE");
    app.add_flag("--json", why.json, "As JSON");
    single(
        app.add_option("--fps", why.fps, "Frames a second, of which --shutter is a share; default: those of the clip, else 24"))
        ->type_name("F")
        ->check(CLI::Range(1e-3, 1e6));
}

void add_check(CLI::App& app, CheckCommand& command) {
    app.add_option("plugins", command.what,  // not "plugin": CLI11 2.4 takes that for the name of --plugin, too
                   "Ids as `clarity plugins` lists them, libraries, or folders of source, which are built first")
        ->type_name("PLUGIN")
        ->required();
    app.add_option("--only", command.options.only,
                   "Only checks with names that begin with this, such as hits, builds.refs or keys; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app.add_flag("--large", command.options.large,
                 "Of structures: also scenes of more than 2^20 triangles, which takes minutes");
    app.add_option("--lanes", command.options.lanes,
                   "Only kernels of this many lanes; may be repeated; default: 1, 4, 8 and 16")
        ->type_name("N")
        ->allow_extra_args(false)
        ->check(CLI::IsMember({1, 4, 8, 16}));
    app.add_flag("--quick", command.options.quick,
                 "Fewer rays, repetitions and compiled variants: about a minute of processor time, where the long form takes "
                 "several");
    app.add_flag("--list", command.options.list, "Only list the checks: their names and what they try");
    single(app.add_option("--seed", command.options.seed,
                          "Other rays, values and damaged files; 0: those of every run without this option"))
        ->type_name("N")
        ->capture_default_str();
    single(app.add_option("--time-limit", command.options.time_limit_s,
                          "Limit for the checks of one plugin; what is cut is not said to be right"))
        ->type_name("SECONDS")
        ->check(CLI::Range(1.0, 1e6));
    single(app.add_option("--oclgrind-time", command.options.oclgrind_time_s,
                          "Processor time for accesses.oclgrind, which then says that it was cut; default: 60"))
        ->type_name("SECONDS")
        ->check(CLI::Range(0.01, 1e6));
    app.add_flag("--stop-at-first", command.options.stop_at_first, "Begin no check after one has failed");
    app.add_option("--samples", command.options.samples,
                   "Of importers: files to read and to damage, or folders with files of its extensions; may be repeated")
        ->type_name("FILE|DIR")
        ->allow_extra_args(false);
    single(app.add_option("--truth", command.options.truth_folder,
                          "Of importers: a folder of .json files with what other programs read from the samples"))
        ->type_name("DIR");
    CLI::Option* const scene =
        app.add_option("--scene", command.scene_files,
                       "Of structures: only trace the rays of --rays in this scene, and compare all hits "
                       "with those of every primitive tested; may be repeated");
    scene->type_name("FILE")->allow_extra_args(false);
    CLI::Option* const rays =
        single(app.add_option("--rays", command.options.rays_file, "The rays for --scene, as `clarity trace` reads them"));
    rays->type_name("FILE")->needs(scene);
    scene->needs(rays);
    app.add_flag("--json", command.json, "As JSON");
    single(app.add_option("--junit", command.junit_file, "Write the results as JUnit's XML, too"))->type_name("FILE");
    single(app.add_option("--report", command.options.report_folder,
                          "Write the rays with wrong answers into this folder, and a picture of the pixels that differ"))
        ->type_name("DIR");
    single(app.add_option("--device", command.options.device, "The device that traces, as `clarity devices` lists them"))
        ->type_name("D");
}

void add_new_plugin(CLI::App& app, NewPluginCommand& command) {
    app.add_option("kind", command.kind,
                   "accel (an acceleration structure), importer, primitive (a shape) or surface (a model of surfaces)")
        ->type_name("KIND")
        ->required();
    app.add_option("id", command.id, "Its name: lower-case letters, digits and _, a letter first")->type_name("ID")->required();
    app.add_option("folder", command.folder, "The new folder; default: ID in the working folder")->type_name("DIR");
}

void add_lab(CLI::App& app, LabCommand& command) {
    app.add_option(
           "action", command.action,
           "new LAB DIR (a copy of a lab, to change), handout LAB DIR (what students get), check [DIR] (what students run, "
           "in the folder that they got), grade LAB SUBMISSION..., night LAB SUBMISSION... (the same by several processes, "
           "which leave "
           "out what has a record), board LAB MARKS (a page of all records)")
        ->type_name("ACTION")
        ->required()
        ->check(CLI::IsMember({"new", "handout", "check", "grade", "night", "board"}));
    app.add_option("words", command.words, "A lab's folder, or the name of one that is installed; then other folders")
        ->type_name("LAB|DIR");
    app.add_option("--only", command.only, "Only this line, such as hits.random or the name of a case; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false);
    single(app.add_option("-o,--output", command.output,
                          "Of grade and night: a folder for a record of each submission, NAME.json; of board: the page"))
        ->type_name("DIR");
    single(app.add_option("--gradescope", command.gradescope, "Of grade: write Gradescope's results.json, first with 0 points"))
        ->type_name("FILE");
    app.add_flag("--autolab", command.autolab, "Of grade: the last line printed is Autolab's, and one with 0 points the first");
    app.add_flag("--counts-only", command.counts_only,
                 "Take no times, on a machine that is not worth it: their points belong to the counts");
    single(app.add_option("--sdk", command.sdk, "The folder that Clarity is installed in; default: that of this program"))
        ->type_name("DIR");
    single(app.add_option(
               "--work", command.work,
               "A folder in which plugins are built, and which later runs use again, one at a time; default: a temporary one"))
        ->type_name("DIR");
    app.add_option(
           "--tools", command.tools,
           "A folder that compilers may read in their sandbox, besides those of the tools that PATH has; may be repeated")
        ->type_name("DIR")
        ->allow_extra_args(false);
    single(app.add_option("--device", command.device, "The device that traces, as `clarity devices` lists them"))
        ->type_name("D");
}

void add_bench(CLI::App& app, BenchCommand& bench) {
    app.add_option("what", bench.what,
                   "thesis (its six tests, then and now), packets, accel (every structure and peer), zoo (every structure on "
                   "eight scenes), shapes (as themselves and as meshes), scale, large (up to 100 M "
                   "triangles), cpu (side by side with the best of each peer), devices (one picture by one, two, ... of "
                   "--device), mpi (one picture by 1, 2, 4 processes that mpirun starts), light (paths of light: errors over "
                   "samples and seconds), moving (refits and rebuilds while "
                   "all vertices move), quick (a minute); or scene files, with a "
                   "suite: instead of its own")
        ->type_name("SUITE|SCENE");
    single(app.add_option("--device", bench.device, "As `clarity devices` lists them; several with commas, or all"))
        ->type_name("D[,D...]");
    app.add_option("--accel", bench.accels, "A structure to compare; may be repeated; default: all which are found")
        ->type_name("ID[,key=value...]")
        ->allow_extra_args(false);
    single(app.add_option("--json", bench.json_file,
                          "Write the records as a JSON list; - writes it to stdout instead of the tables"))
        ->type_name("FILE");
    single(app.add_option("--csv", bench.csv_file, "Write the records as CSV"))->type_name("FILE");
    single(app.add_option("--report", bench.report_folder, "Write a page with charts, index.html, into this folder"))
        ->type_name("DIR");
    app.add_option("--join", bench.join_files, "Add the records of an earlier run (its --json); may be repeated")
        ->type_name("FILE")
        ->allow_extra_args(false);
    app.add_option("--only", bench.only, "Only cases with this in their name, such as bunny/ or /shadow; may be repeated")
        ->type_name("TEXT")
        ->allow_extra_args(false);
    app.add_flag("--list", bench.list, "Only list what would be measured");
    app.add_flag("--no-peers,--no-baselines", bench.no_baselines, "Leave out the baselines: other ray tracers (peers)");
    single(app.add_option("--time-limit", bench.time_limit_s, "Limit for the whole run; default: the limits of the suites"))
        ->type_name("SECONDS")
        ->check(CLI::Range(1.0, 1e6));
    single(app.add_option("--max-spread", bench.max_spread,
                          "Refuse a row if the middle half of its repetitions spreads over more than this share of the median, "
                          "0.1 or 10%"))
        ->type_name("SHARE")
        ->transform(percent())
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    app.add_flag("--processor-time", bench.by_processor,
                 "Time rays on CPUs, and builds, by what processors spent on them, all threads together: steady on a busy "
                 "machine, where clocks are not");
    single(app.add_option("--max-triangles", bench.max_triangles, "Largest model of the suites scale, large and zoo"))
        ->type_name("N")
        ->capture_default_str();
    app.add_option("--ranks", bench.ranks, "Of suite mpi: how many processes share a picture, one number a row; default: 1,2,4")
        ->type_name("N[,N...]")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(1u, 4096u));
    app.add_option("--threads", bench.threads,
                   "Run once with each of these numbers of processors, and show what rows gain, such as 1,2,4,8,16")
        ->type_name("N[,N...]")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(1u, 1024u));
    single(app.add_option("--mpirun", bench.mpirun,
                          "Of suite mpi: what starts them, with its options; default: mpirun --bind-to none --oversubscribe"))
        ->type_name("COMMAND");
    single(app.add_option(
               "--reference", bench.reference,
               "Of suite light: what should come out, .pfm, .exr or .png; default: a picture of 16 times as many samples"))
        ->type_name("FILE")
        ->check(CLI::ExistingFile);
    app.add_option("--search-path", bench.import.search_paths,
                   "A folder which the scene may read files from, besides its own; may be repeated")
        ->type_name("DIR")
        ->allow_extra_args(false);
    add_settings(app, bench.settings, bench.sets);
}

}  // namespace clarity
