#include "sha256.h"

#include <stdint.h>
#include <string.h>

/* Names and numbers as in FIPS 180-4: the words a ... h of the state, K, the message schedule W. */
#define BLOCK 64

/* The first 32 bits of the fractions of the cube roots of the first 64 primes [4.2.2]. */
static const uint32_t sha256_K[BLOCK] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t rotated(uint32_t x, int n)
{
    return x >> n | x << (32 - n);
}

/* Takes one block into the state [6.2.2]. */
static void take_block(uint32_t H[8], const unsigned char *block)
{
    uint32_t W[BLOCK];
    for (int t = 0; t < 16; t++, block += 4)
        W[t] = (uint32_t)block[0] << 24 | (uint32_t)block[1] << 16 | (uint32_t)block[2] << 8 | block[3];
    for (int t = 16; t < BLOCK; t++) {
        uint32_t x = W[t - 15], y = W[t - 2];
        uint32_t sigma0 = rotated(x, 7) ^ rotated(x, 18) ^ x >> 3;
        uint32_t sigma1 = rotated(y, 17) ^ rotated(y, 19) ^ y >> 10;
        W[t] = sigma1 + W[t - 7] + sigma0 + W[t - 16];
    }
    uint32_t a = H[0], b = H[1], c = H[2], d = H[3], e = H[4], f = H[5], g = H[6], h = H[7];
    for (int t = 0; t < BLOCK; t++) {
        uint32_t Sigma0 = rotated(a, 2) ^ rotated(a, 13) ^ rotated(a, 22);
        uint32_t Sigma1 = rotated(e, 6) ^ rotated(e, 11) ^ rotated(e, 25);
        uint32_t T1 = h + Sigma1 + ((e & f) ^ (~e & g)) + sha256_K[t] + W[t];
        uint32_t T2 = Sigma0 + ((a & b) ^ (a & c) ^ (b & c));
        h = g, g = f, f = e, e = d + T1;
        d = c, c = b, b = a, a = T1 + T2;
    }
    const uint32_t after[8] = {a, b, c, d, e, f, g, h};
    for (int k = 0; k < 8; k++)
        H[k] += after[k];
}

void sha256(const unsigned char *bytes, size_t size, char digest[SHA256_SIZE])
{
    static const char digits[] = "0123456789abcdef";
    /* The first 32 bits of the fractions of the square roots of the first 8 primes [5.3.3]. */
    uint32_t H[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                     0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    size_t whole = size / BLOCK * BLOCK, rest = size - whole;
    for (size_t k = 0; k < whole; k += BLOCK)
        take_block(H, bytes + k);
    /* The end [5.1.1]: a one, zeros, the length in bits, in one block or two. */
    unsigned char end[2 * BLOCK] = {0};
    size_t length = rest < BLOCK - 8 ? BLOCK : 2 * BLOCK;
    uint64_t bits = (uint64_t)size * 8;
    memcpy(end, bytes + whole, rest);
    end[rest] = 0x80;
    for (size_t k = 1; k <= 8; k++, bits >>= 8)
        end[length - k] = (unsigned char)(bits & 0xFF);
    for (size_t k = 0; k < length; k += BLOCK)
        take_block(H, end + k);
    for (int k = 0; k < 64; k++)
        digest[k] = digits[H[k / 8] >> (28 - k % 8 * 4) & 15];
    digest[64] = 0;
}
