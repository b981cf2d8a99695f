// Curves over time: published ones read from a table, simulated ones, and how far they are apart.
#pragma once

#include <string>
#include <vector>

namespace froude::validation {

struct Curve {
  std::vector<double> t, z;  // t grows
  void add(double time, double value) {
    t.push_back(time);
    z.push_back(value);
  }
  /// Linear between the points; NaN outside of them.
  double at(double time) const;
  /// Cubic through the four points about it, for curves without noise: an error of the order of the fourth power of
  /// the points' distance. At least four points; `time` between the first and the last.
  double smoothAt(double time) const;
  /// Of the piecewise linear curve, over from … to, which must lie within it. Cost: the points.
  double mean(double from, double to) const;
  /// First time when the piecewise linear curve is at `level` or above; NaN if it never is.
  double reaches(double level) const;
};

/// The median of what lies within half of `width` on either side, at each point. Cost: n w log w for w points in a
/// width.
Curve medianFiltered(const Curve& curve, double width);

/// Means of a value that holds along pieces of time, over windows of one length that begin at 0. A piece that reaches
/// over several windows counts in each by its share.
class WindowMeans {
 public:
  explicit WindowMeans(double length) : length_(length) {}
  /// value from … to, 0 ≤ from; pieces in any order.
  void add(double from, double to, double value);
  std::size_t count() const { return windows_.size(); }
  double from(std::size_t k) const { return length_ * static_cast<double>(k); }
  double mean(std::size_t k) const { return windows_[k].sum / windows_[k].time; }
  /// Variance about the mean.
  double variance(std::size_t k) const;

 private:
  struct Window {
    double sum = 0.0, square = 0.0, time = 0.0;
  };
  double length_;
  std::vector<Window> windows_;
};

/// Two columns (by index) of a CSV file whose lines of numbers begin with a digit; with `series`, of its lines that
/// begin with that word and a comma, which is then column 0. Throws Error for a file that cannot be read or has no such
/// line.
Curve readCurve(const std::string& file, std::size_t columnT, std::size_t columnZ, const std::string& series = "");

/// How far a curve is from another one's points.
struct Distance {
  double rms = 0.0;    // of (z − z_reference)/z_reference
  double shift = 0.0;  // by which the curve came later
};
/// Over the points of `reference` from `from` to `to`, after the one shift 0 ≤ shift ≤ `most` (in hundredths) that fits
/// best. Points that the shifted curve does not reach make that shift no candidate; rms is NaN if there is none.
Distance bestShift(const Curve& curve, const Curve& reference, double from, double to, double most);

/// Rms of z − z_reference over the points of `reference` that the curve, coming later by `shift`, reaches.
double rmsDifference(const Curve& curve, const Curve& reference, double shift);

}  // namespace froude::validation
