#include "cli/program.h"

#include <fmt/format.h>

#include <cstdio>
#include <new>
#include <string>
#include <vector>

#include "cli/description.h"
#include "cli/doctor.h"
#include "cli/explain.h"
#include "cli/field.h"
#include "cli/request.h"
#include "export/frames.h"
#include "run/exit_codes.h"
#include "run/progress.h"
#include "scene/svg_drawing.h"

namespace froude::cli {
namespace {

using namespace run;

// Runs what was asked for, one overload for each.
struct Dispatch {
  const Studies& studies;

  int operator()(const plan::ChartOptions& r) const {
    if (studies.chart == nullptr) throw UsageError("chart: this program was built without the validation cases");
    return studies.chart(r);
  }
  int operator()(const PrintRequest& r) const { return fmt::print("{}", r.text), kDone; }
  int operator()(const RunOptions& r) const { return runScene(r); }
  int operator()(const ResumeOptions& r) const { return resumeRun(r); }
  int operator()(const CheckRequest& r) const {
    return scene::checkCommand(study::itemsToCheck(r.scenes), r.strict, r.json);
  }
  int operator()(const study::BatchOptions& r) const { return study::runBatch(r); }
  int operator()(const ExplainRequest& r) const { return explainCommand(r.scene, r.json); }
  int operator()(const FieldRequest& r) const { return fieldCommand(r); }
  int operator()(const plan::ScalingOptions& r) const { return plan::scalingCommand(r); }
  int operator()(const DescribeRequest& r) const {
    const ProgramText program = describeProgram();
    fmt::print("{}", r.shell.empty() ? manualPage(program) : completionScript(program, r.shell));
    return kDone;
  }
  int operator()(const DoctorRequest& r) const { return doctorCommand(r.json); }
};

int fail(int code, const std::string& what) {
  fmt::print(stderr, "{}{}\n", label("error"), what);
  return code;
}

int dispatch(int argc, const char* const* argv, const Studies& studies) {
  try {
    return std::visit(Dispatch{studies}, parseCommandLine({argv, argv + argc}));
  } catch (const scene::SceneError& e) {
    fmt::print(stderr, "{}\n", e.what());  // begins with FILE:LINE:COLUMN, so that editors find the place
    return kUsageError;
  } catch (const scene::DrawingError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return kUsageError;
  } catch (const UsageError& e) {
    return fail(kUsageError, e.what());
  } catch (const InputError& e) {
    return fail(kOutputError, e.what());
  } catch (const exporting::OutputError& e) {
    return fail(kOutputError, e.what());
  } catch (const std::bad_alloc&) {
    return fail(kInternalError, "there is not enough memory");
  } catch (const std::exception& e) {
    return fail(kInternalError, std::string("internal: ") + e.what());
  }
}

}  // namespace

int runProgram(int argc, const char* const* argv, const Studies& studies) {
  const int code = dispatch(argc, argv, studies);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return fail(code == kDone ? int{kOutputError} : code, "standard output cannot be written");
}

}  // namespace froude::cli
