#pragma once
/// Shading normals of a label's surface from the scan's own grey values: smooth where the label's
/// voxels make steps. Only the light changes; the surface stays where the labels, and so the
/// contacts, are.

#include <vector>

#include "imaging/surface.h"
#include "imaging/volume.h"

namespace palpate::ui {

/// Gradient of the trilinear grey values at a point of P (metres), per metre, in P. Zero outside.
[[nodiscard]] Eigen::Vector3d greyGradient_P(const Volume& volume, const Eigen::Vector3d& p_P);

/// Replaces each normal by the grey gradient's direction, weighted against the label's own; where
/// the two disagree by more than 66° the label's is kept. Any thread.
void shadeByGrey(std::vector<SurfaceChunk>& chunks, const Volume& volume);

}  // namespace palpate::ui
