// What is left of a run's gauges in one row of a table: of each column its end, its extremes and its mean.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace froude::study {

/// From the text of a gauges.csv: for each column NAME the values gauge.NAME.last, .min, .max and .mean, with 17
/// digits. The mean is that of the piecewise linear course over time (of one value: that value). Empty cells do not
/// count, nor do values that are not finite, but for the last; a column without a finite value has "nan". Empty for an
/// empty text. Throws run::InputError.
std::vector<std::pair<std::string, std::string>> gaugeStatistics(const std::string& text, const std::string& file);

}  // namespace froude::study
