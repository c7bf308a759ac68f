// SPDX-License-Identifier: GPL-2.0-only
// The place of a contact's point in its host, step by step.

#pragma once

#include "contact/contact_kernel.h"
#include "contact/material_map.h"

namespace mdanim {

// X of the point, now at x, is that of the weights plus `off`; everything is linear about the former. False when it cannot be
// found.
bool follow(FieldContact &contact, const PushTask &task, const ContactBody &host, const Vec3 &x, MapWeights &weights,
            Spot<double> &spot, Vec3 &off);

}    // namespace mdanim
