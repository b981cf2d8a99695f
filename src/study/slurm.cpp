#include "study/slurm.h"

#include <fmt/format.h>

#include "export/frames.h"
#include "run/exit_codes.h"
#include "run/machine.h"
#include "run/process.h"

namespace froude::study {
namespace {

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

// In words of sbatch a % stands for numbers of the job.
std::string pattern(const std::string& path) {
  std::string text;
  for (const char c : path) text += c == '%' ? std::string("%%") : std::string(1, c);
  return text;
}

}  // namespace

std::string arrayIndices(const std::vector<std::size_t>& which) {
  std::string text;
  for (std::size_t i = 0; i < which.size();) {
    std::size_t last = i;
    while (last + 1 < which.size() && which[last + 1] == which[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ",", which[i]);
    if (last > i) text += fmt::format("-{}", which[last]);
    i = last + 1;
  }
  return text;
}

std::string jobScript(const std::string& program, const std::string& folder, const std::vector<std::size_t>& which,
                      int threads) {
  std::string text = "#!/bin/sh\n";
  text += "#SBATCH --job-name=froude\n";
  text += fmt::format("#SBATCH --array={}\n", arrayIndices(which));
  text += "#SBATCH --nodes=1 --ntasks=1\n";
  if (threads > 0) text += fmt::format("#SBATCH --cpus-per-task={}\n", threads);
  text += "#SBATCH --requeue --open-mode=append\n";
  text += "#SBATCH --signal=B:TERM@60\n";
  text += fmt::format("#SBATCH --output=\"{}/slurm-%a.log\"\n", pattern(folder));
  text += R"(
# One run of the batch a task. Whatever ends it, the same task begun again goes on from its last checkpoint.
# A minute before the time limit the shell is sent SIGTERM: the run saves its state, and the task queues again.
)";
  text += fmt::format("{} batch -o {} --task \"$SLURM_ARRAY_TASK_ID\" --quiet &\n", quoted(program), quoted(folder));
  text += R"(child=$!
trap 'kill -TERM "$child" 2>/dev/null' TERM
wait "$child"
code=$?
while kill -0 "$child" 2>/dev/null; do
  wait "$child"
  code=$?
done
if [ "$code" -eq 143 ]; then scontrol requeue "$SLURM_JOB_ID"; fi
exit "$code"
)";
  return text;
}

void requireSlurm() {
  if (run::findProgram("sbatch").empty())
    throw run::UsageError("--slurm: there is no sbatch on PATH; this is no machine that hands in jobs to Slurm");
}

std::string submit(const std::string& script) {
  const run::ProcessResult result = run::runProcess({"sbatch", "--parsable", script}, {}, run::Listen::ToAll);
  if (!result.ok()) throw exporting::OutputError("sbatch " + script + ": " + trimmed(result.errors));
  const std::string answer = trimmed(result.errors);  // "12" or "12;cluster"
  return answer.substr(0, answer.find(';'));
}

}  // namespace froude::study
