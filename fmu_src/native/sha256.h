/* The checksum of the resource files. */
#ifndef MODALFMU_SHA256_H
#define MODALFMU_SHA256_H

#include "common.h"

#define SHA256_SIZE 65 /* 64 hexadecimal digits and the final 0 */

/* The SHA-256 of the bytes, in lower-case hexadecimal digits. */
INTERNAL void sha256(const unsigned char *bytes, size_t size, char digest[SHA256_SIZE]);

#endif
