// `froude field`: the distance field of one shape, drawn, asked at points, or compared.
#pragma once

#include "cli/request.h"

namespace froude::cli {

/// Returns the exit code. Throws scene::SceneError for a shape or points that are wrong, exporting::OutputError.
int fieldCommand(const FieldRequest& request);

}  // namespace froude::cli
