#pragma once
/// R, L, A, P, H, F: which way a direction points in the patient (DICOM LPS).

#include <Eigen/Core>
#include <string>

namespace palpate::ui {

/// One to three letters, the strongest component first; a component under sin(15°) of the length is
/// left out. +x L, -x R; +y P, -y A; +z H, -z F. Empty for a zero direction.
[[nodiscard]] std::string orientationLetters(const Eigen::Vector3d& direction_P);

}  // namespace palpate::ui
