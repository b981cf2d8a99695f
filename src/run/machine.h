// The machine that a run finds itself on: cores it may use, memory that is free, the processor's name.
#pragma once

#include <cstdint>
#include <string>

namespace froude::run {

/// Cores that this process may use: the smallest of its affinity mask, the CPU quota of its control group (version 2,
/// rounded up, limits of parent groups included) and SLURM_CPUS_PER_TASK. At least 1.
int usableCores();

/// Bytes that can still be allocated without swapping: MemAvailable, less what the control group and
/// `ulimit -v` forbid; 0 if unknown.
std::uint64_t availableMemoryBytes();

/// "AMD EPYC 9B45"; "unknown" where the system does not say.
std::string cpuName();

/// The program `name` somewhere on PATH, as a full path; empty when it is not installed.
std::string findProgram(const std::string& name);

/// The full path of this program.
std::string programPath();

/// A size for people: "512 MB", "1.3 TB"; decimal units.
std::string bytesInWords(double bytes);

}  // namespace froude::run
