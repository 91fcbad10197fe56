/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of glTF share. */
#ifndef GLTF_TEST_H
#define GLTF_TEST_H

#include "external_test.h"

/** A wedge (0,0,0) (1,0,0) (0,1,0) (0,0,1), its volume 1/6: 4 positions, then 12 indices of 16 bits. */
#define WEDGE \
  "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAACAAEAAAABAAMAAQACAAMAAgAAAAMA"

#endif
