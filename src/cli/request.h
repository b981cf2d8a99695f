// What a command line asks for, as plain values.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "export/field_painter.h"
#include "plan/chart_options.h"
#include "plan/scaling.h"
#include "run/run.h"
#include "scene/shape_argument.h"
#include "study/batch.h"

namespace froude::cli {

/// `--help` and `--version`: a text for stdout.
struct PrintRequest {
  std::string text;
};
struct CheckRequest {
  std::vector<std::string> scenes;
  bool strict = false, json = false;
};
struct ExplainRequest {
  std::string scene;
  bool json = false;
};
/// One of: a picture, answers at points, a comparison.
struct FieldRequest {
  std::string shape;
  scene::SvgOptions svg;
  std::string output;  // .png or .svg; with points .csv, or empty for stdout
  std::string points;  // "-": standard input
  bool check = false;
  exporting::FieldPicture picture;
};
/// A script for a shell, or the manual page where none is named.
struct DescribeRequest {
  std::string shell;
};
struct DoctorRequest {
  bool json = false;
};

using Request =
    std::variant<PrintRequest, run::RunOptions, run::ResumeOptions, CheckRequest, ExplainRequest, FieldRequest,
                 study::BatchOptions, plan::ChartOptions, plan::ScalingOptions, DescribeRequest, DoctorRequest>;

/// Reads a command line; `arguments[0]` is the program. Throws run::UsageError with what is wrong and what would be
/// right.
Request parseCommandLine(const std::vector<std::string>& arguments);

/// The words of a command line as a shell would take them back.
std::string quoted(const std::vector<std::string>& arguments);

}  // namespace froude::cli
