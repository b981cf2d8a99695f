#include "validation/curve.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include <froude/base/error.h>

namespace froude::validation {

double Curve::at(double time) const {
  for (std::size_t i = 0; i + 1 < t.size(); ++i)
    if (t[i] <= time && time <= t[i + 1]) return z[i] + (z[i + 1] - z[i]) * (time - t[i]) / (t[i + 1] - t[i]);
  return std::nan("");
}

Curve readCurve(const std::string& file, std::size_t columnT, std::size_t columnZ, const std::string& series) {
  std::ifstream stream(file);
  Curve curve;
  for (std::string line; std::getline(stream, line);) {
    const bool wanted =
        series.empty() ? !line.empty() && line[0] >= '0' && line[0] <= '9' : line.rfind(series + ",", 0) == 0;
    if (!wanted) continue;
    std::vector<std::string> cells;
    std::stringstream words(line);
    for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
    if (cells.size() <= columnT || cells.size() <= columnZ)
      throw Error(file + ": a line with too few columns: " + line);
    curve.add(std::stod(cells[columnT]), std::stod(cells[columnZ]));
  }
  if (curve.t.empty()) throw Error(file + ": no curve to compare with");
  return curve;
}

Distance bestShift(const Curve& curve, const Curve& reference, double from, double to, double most) {
  Distance best{std::nan(""), 0.0};
  for (int k = 0; 0.01 * k <= most * (1.0 + 1e-9); ++k) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < reference.t.size(); ++i) {
      if (reference.t[i] < from || reference.t[i] > to) continue;
      sum += std::pow((curve.at(reference.t[i] - 0.01 * k) - reference.z[i]) / reference.z[i], 2);
      ++count;
    }
    const double rms = std::sqrt(sum / count);
    if (std::isfinite(rms) && !(rms >= best.rms)) best = {rms, 0.01 * k};
  }
  return best;
}

double rmsDifference(const Curve& curve, const Curve& reference, double shift) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < reference.t.size(); ++i) {
    const double difference = curve.at(reference.t[i] - shift) - reference.z[i];
    if (!std::isfinite(difference)) continue;
    sum += difference * difference;
    ++count;
  }
  return std::sqrt(sum / count);
}

}  // namespace froude::validation
