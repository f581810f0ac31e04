#pragma once
/// Otsu's thresholds: the cuts of a histogram that leave the least variance within its classes.
/// Source: Otsu, "A threshold selection method from gray-level histograms", 1979.
///
/// The brightest thousandth of the voxels counts as no brighter than the 99.9th percentile (bright
/// vessels and artefacts would draw the cuts up). Whole numbers that span less than 65,536, so
/// every int16 volume: the best of all cuts, exactly. Other values: the best of the cuts between
/// 65,536 equal bins, each weighed by the values in it.
///
/// A cut is the smallest value of its upper class that occurs: values at or above it are that
/// class. Where all values are equal, that value; of an empty volume 0.

#include <utility>

#include "imaging/volume.h"

namespace palpate {

/// The cut between two classes.
[[nodiscard]] double otsuThreshold(const Volume& volume);
/// Two cuts between three classes, low then high; the same where only two values occur.
[[nodiscard]] std::pair<double, double> otsuThresholds2(const Volume& volume);

}  // namespace palpate
