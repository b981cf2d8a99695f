// `froude explain`: what of a scene is modelled, what is not, and why; and what a run of it will cost.
#pragma once

#include <string>

namespace froude::cli {

/// Prints to stdout; returns the exit code. Builds the scene's world and runs its first moments, at most a second, to
/// measure what a sub-step costs. Throws scene::SceneError.
int explainCommand(const std::string& file, bool json);

}  // namespace froude::cli
