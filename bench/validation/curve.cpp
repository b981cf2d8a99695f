#include "validation/curve.h"

#include <algorithm>
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

double Curve::smoothAt(double time) const {
  const std::size_t after = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), time) - t.begin());
  const std::size_t first = std::min(after < 2 ? 0 : after - 2, t.size() - 4);
  double sum = 0.0;
  for (std::size_t i = first; i < first + 4; ++i) {  // Lagrange
    double share = 1.0;
    for (std::size_t j = first; j < first + 4; ++j)
      if (j != i) share *= (time - t[j]) / (t[i] - t[j]);
    sum += share * z[i];
  }
  return sum;
}

double Curve::mean(double from, double to) const {
  double sum = 0.0, before = from, value = at(from);
  const auto piece = [&](double time, double next) {
    sum += 0.5 * (value + next) * (time - before);
    before = time;
    value = next;
  };
  for (std::size_t i = 0; i < t.size(); ++i)
    if (from < t[i] && t[i] < to) piece(t[i], z[i]);
  piece(to, at(to));
  return sum / (to - from);
}

double Curve::reaches(double level) const {
  if (!z.empty() && z[0] >= level) return t[0];
  for (std::size_t i = 1; i < z.size(); ++i)
    if (z[i] >= level) return t[i - 1] + (t[i] - t[i - 1]) * (level - z[i - 1]) / (z[i] - z[i - 1]);
  return std::nan("");
}

Curve medianFiltered(const Curve& curve, double width) {
  Curve filtered;
  std::size_t begin = 0, end = 0;
  std::vector<double> near;
  for (std::size_t i = 0; i < curve.t.size(); ++i) {
    while (curve.t[begin] < curve.t[i] - 0.5 * width) ++begin;
    while (end < curve.t.size() && curve.t[end] <= curve.t[i] + 0.5 * width) ++end;
    near.assign(curve.z.begin() + static_cast<std::ptrdiff_t>(begin),
                curve.z.begin() + static_cast<std::ptrdiff_t>(end));
    const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
    std::nth_element(near.begin(), middle, near.end());
    const double upper = *middle;
    const bool even = near.size() % 2 == 0;
    filtered.add(curve.t[i], even ? 0.5 * (upper + *std::max_element(near.begin(), middle)) : upper);
  }
  return filtered;
}

void WindowMeans::add(double from, double to, double value) {
  for (auto k = static_cast<std::size_t>(from / length_); this->from(k) < to; ++k) {
    const double time = std::min(to, this->from(k + 1)) - std::max(from, this->from(k));
    if (time <= 0.0) continue;  // rounding at the edge of a window
    if (windows_.size() <= k) windows_.resize(k + 1);
    windows_[k].sum += value * time;
    windows_[k].square += value * value * time;
    windows_[k].time += time;
  }
}

double WindowMeans::variance(std::size_t k) const {
  return std::max(0.0, windows_[k].square / windows_[k].time - mean(k) * mean(k));
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
