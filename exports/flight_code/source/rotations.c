/* SPDX-License-Identifier: Apache-2.0 */
/* Rotations from quaternions and from Euler angles. */
#include "maths.h"

#if QT_WITH_GENERAL
void qt_quaternion_product(const qt_real a[4], const qt_real b[4], qt_real c[4]) {
  c[0] = (((a[0] * b[0]) - (a[1] * b[1])) - (a[2] * b[2])) - (a[3] * b[3]);
  c[1] = (((a[0] * b[1]) + (a[1] * b[0])) + (a[2] * b[3])) - (a[3] * b[2]);
  c[2] = (((a[0] * b[2]) - (a[1] * b[3])) + (a[2] * b[0])) + (a[3] * b[1]);
  c[3] = (((a[0] * b[3]) + (a[1] * b[2])) - (a[2] * b[1])) + (a[3] * b[0]);
}

void qt_quaternion_of_euler(qt_real roll, qt_real pitch, qt_real yaw, qt_real q[4]) {
  qt_real cr;
  qt_real sr;
  qt_real cp;
  qt_real sp;
  qt_real cy;
  qt_real sy;
  qt_sine_and_cosine(roll * 0.5f, &sr, &cr);
  qt_sine_and_cosine(pitch * 0.5f, &sp, &cp);
  qt_sine_and_cosine(yaw * 0.5f, &sy, &cy);
  q[0] = ((cr * cp) * cy) + ((sr * sp) * sy);
  q[1] = ((sr * cp) * cy) - ((cr * sp) * sy);
  q[2] = ((cr * sp) * cy) + ((sr * cp) * sy);
  q[3] = ((cr * cp) * sy) - ((sr * sp) * cy);
}

void qt_rotation_of_quaternion(const qt_real q[4], qt_real R[9]) {
  const qt_real x2 = q[1] + q[1];
  const qt_real y2 = q[2] + q[2];
  const qt_real z2 = q[3] + q[3];
  const qt_real xx = q[1] * x2;
  const qt_real yy = q[2] * y2;
  const qt_real zz = q[3] * z2;
  const qt_real xy = q[1] * y2;
  const qt_real xz = q[1] * z2;
  const qt_real yz = q[2] * z2;
  const qt_real wx = q[0] * x2;
  const qt_real wy = q[0] * y2;
  const qt_real wz = q[0] * z2;
  R[0] = 1.0f - (yy + zz);
  R[1] = xy - wz;
  R[2] = xz + wy;
  R[3] = xy + wz;
  R[4] = 1.0f - (xx + zz);
  R[5] = yz - wx;
  R[6] = xz - wy;
  R[7] = yz + wx;
  R[8] = 1.0f - (xx + yy);
}

#endif
void qt_rotation_of_euler(qt_real roll, qt_real pitch, qt_real yaw, qt_real R[9]) {
  qt_real cr;
  qt_real sr;
  qt_real cp;
  qt_real sp;
  qt_real cy;
  qt_real sy;
  qt_sine_and_cosine(roll, &sr, &cr);
  qt_sine_and_cosine(pitch, &sp, &cp);
  qt_sine_and_cosine(yaw, &sy, &cy);
  R[0] = cy * cp;
  R[1] = ((cy * sp) * sr) - (sy * cr);
  R[2] = ((cy * sp) * cr) + (sy * sr);
  R[3] = sy * cp;
  R[4] = ((sy * sp) * sr) + (cy * cr);
  R[5] = ((sy * sp) * cr) - (cy * sr);
  R[6] = -sp;
  R[7] = cp * sr;
  R[8] = cp * cr;
}
