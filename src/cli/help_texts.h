// What stands below the options in `--help` of each command: an example and the exit codes.
#pragma once

#include <string_view>

namespace froude::cli {

inline constexpr std::string_view kRunFooter = R"(Example:
  froude run scenes/dam_break.toml -o out/dam --set model.spacing=0.02 --frames png

The last line on stdout is the run's folder; pictures, gauges.csv and summary.json are in it.
Exit codes: 0 done; 1 internal error; 2 the command line or the scene is wrong, nothing was written;
3 the simulation went unstable and was stopped, the last sound state is kept; 4 input or output failed;
130 SIGINT and 143 SIGTERM, both after a checkpoint (a second signal ends at once).)";

inline constexpr std::string_view kBatchFooter = R"(Examples:
  froude batch scenes/dam_break.toml -o out/dams --sweep model.spacing=0.04,0.02 --sweep fluid.viscosity=1e-6,1e-3
  froude batch -o out/dams --resume
  froude batch scenes/sweep.toml -o out/more --baseline out/dams/results.csv

Each run has a folder below DIR, named by its parameters; DIR/results.csv has a row for each, with its parameters, every
number of its summary and the statistics of its gauges. Small runs stand side by side, large ones take all cores.
The last line on stdout is DIR. docs/batches.md describes batch files, docs/scale.md clusters.
Exit codes: 0 all runs are done; 1 internal error; 2 the command line, a batch file or every scene is wrong, nothing was
written; 4 the table cannot be written; 5 some runs are not done, the table says why; 130 SIGINT and 143 SIGTERM, after
a checkpoint of every run at work.)";

inline constexpr std::string_view kChartFooter = R"(Examples:
  froude chart --quick
  froude chart -o out/dams --cases dam,martin_moyce --models pbf,apic

Each point is one run: a case, a model, a spacing, a step. DIR/points.csv has a line for each, chart.svg, chart.png and index.html
show time against error. What was measured by this build on this machine is not measured again, so a chart may be stopped and goes on.
The whole of it takes hours. The last line on stdout is DIR. docs/chart.md says what is drawn.
Exit codes: 0 done; 1 internal error; 2 the command line is wrong; 4 input or output failed;
130 SIGINT and 143 SIGTERM, with what was measured drawn.)";

inline constexpr std::string_view kBenchFooter = R"(Example:
  froude bench scaling --quick --subjects pbf,apic

Runs shipped scenes at growing numbers of particles on one thread and on all cores, in turn. DIR/scaling.csv has a row for each,
scaling.svg and scaling.png show them; the table is on stdout, with DIR as the last line. docs/scaling.md says what was found.
Exit codes: 0 done; 1 internal error; 2 the command line is wrong, or the build has assertions; 4 the rows or pictures
cannot be written; 130 SIGINT and 143 SIGTERM, with what was measured.)";

inline constexpr std::string_view kCompletionFooter = R"(Example:
  froude completion bash > ~/.local/share/bash-completion/completions/froude

An installed froude brings the scripts along.
Exit codes: 0 written; 1 internal error; 2 there is no script for this shell; 4 it cannot be written.)";

inline constexpr std::string_view kManFooter = R"(Example:
  froude man > froude.1

Exit codes: 0 written; 1 internal error; 2 the command line is wrong; 4 it cannot be written.)";

inline constexpr std::string_view kResumeFooter = R"(Example:
  froude resume out/dam

The run goes on from its checkpoint.h5 with the same bits as if it had never stopped, or from the one before it where
that is damaged, which is said. Files later than the checkpoint are dropped first. The last line on stdout is the run's folder.
Exit codes: 0 done, or there was nothing left to do; 1 internal error; 2 this is not the folder of a run, it has no
checkpoint, or it was computed with another SIMD target; 3 unstable; 4 the checkpoint cannot be read, or output failed;
130 SIGINT and 143 SIGTERM, both after a checkpoint.)";

inline constexpr std::string_view kCheckFooter = R"(Example:
  froude check scenes/*.toml --strict

Problems go to stderr as FILE:LINE:COLUMN: key: what is wrong, what would be right.
Exit codes: 0 all scenes can be run (warnings are told); 1 internal error; 2 a scene is wrong, or with --strict has
warnings; 4 the findings cannot be written.)";

inline constexpr std::string_view kExplainFooter = R"(Example:
  froude explain scenes/dam_break.toml

Runs the first moments of the scene to measure what a step costs; writes nothing.
Exit codes: 0 explained; 1 internal error; 2 the scene is wrong; 4 the explanation cannot be written.)";

inline constexpr std::string_view kFieldFooter = R"(Example:
  froude field scenes/shapes/gear.toml -o gear.png --offset 0.05 --offset -0.05
  froude field scenes/shapes/gear.toml -o gear.html
  froude field scenes/mill.toml#wheel --at points.csv
  froude field scenes/drawings/harbour.svg#buoy --check

SHAPE is FILE.toml with one line shape = { ... } as in a scene, SCENE.toml#BODY in the body's own frame, FILE.csv with
x,y of a vertex in each row, or FILE.svg#ID, an element or a group of a drawing (without #ID all of it).
--at reads x,y from each row and prints x,y,distance,normal_x,normal_y,closest_x,closest_y; the distance [m] is negative
inside and exact everywhere.
Exit codes: 0 done; 1 internal error; 2 the command line, the shape or a row of points is wrong, nothing was written;
4 the picture or the table cannot be written.)";

inline constexpr std::string_view kDoctorFooter = R"(Example:
  froude doctor --json

Exit codes: 0 told; 1 internal error; 2 the command line is wrong; 4 the findings cannot be written.)";

}  // namespace froude::cli
