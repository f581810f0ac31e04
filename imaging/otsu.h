#pragma once
/// Otsu's thresholds: the cuts of a histogram that leave the least variance within its classes.
/// Source: Otsu, "A threshold selection method from gray-level histograms", 1979.

#include <utility>

#include "imaging/volume.h"

namespace palpate {

/// The cut between two classes: values at or above it are the upper class. Over 256 equal bins from
/// the smallest value to the 99.9th percentile (bright vessels and artefacts would stretch them).
[[nodiscard]] double otsuThreshold(const Volume& volume);
/// Two cuts between three classes, low then high.
[[nodiscard]] std::pair<double, double> otsuThresholds2(const Volume& volume);

}  // namespace palpate
