// The program froude; all of it is behind runProgram, so that tests can link it.
#include "cli/program.h"
#include "validation/chart.h"

int main(int argc, char** argv) {
  return froude::cli::runProgram(argc, argv, {.chart = froude::validation::chartCommand});
}
