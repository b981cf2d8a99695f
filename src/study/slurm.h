// A batch as a job array of Slurm: the script that it submits, and the submission.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace froude::study {

/// "0-3,7": indices as sbatch's --array takes them. Precondition: rising.
std::string arrayIndices(const std::vector<std::size_t>& which);

/// The job script: one run of the batch a task, by `froude batch -o FOLDER --task N`. At the signal before the time
/// limit the run saves its state, and the task asks to be queued again. `program`: the full path of froude; `folder`:
/// that of the batch; `threads` 0: what the cluster gives a task by default.
std::string jobScript(const std::string& program, const std::string& folder, const std::vector<std::size_t>& which,
                      int threads);

/// Throws UsageError where jobs cannot be handed in.
void requireSlurm();

/// Hands a script to sbatch; returns the number of the job. Throws OutputError with sbatch's own words when it refuses.
std::string submit(const std::string& script);

}  // namespace froude::study
