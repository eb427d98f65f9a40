// CRC-32 (ISO 3309, the one of zlib and PNG), eight bytes at a time.
#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

static uint32_t table[8][256];
static pthread_once_t is_made = PTHREAD_ONCE_INIT;

static void make_table(void) {
    for (uint32_t byte = 0; byte < 256; ++byte) {
        uint32_t rest = byte;
        for (int bit = 0; bit < 8; ++bit) {
            rest = rest & 1 ? 0xedb88320u ^ (rest >> 1) : rest >> 1;
        }
        table[0][byte] = rest;
    }
    for (int slice = 1; slice < 8; ++slice) {
        for (int byte = 0; byte < 256; ++byte) {
            const uint32_t rest = table[slice - 1][byte];
            table[slice][byte] = table[0][rest & 0xff] ^ (rest >> 8);
        }
    }
}

// Checksum of bytes that follow those with the checksum `before`; 0 at the beginning.
int64_t base_checksum(int64_t before, const unsigned char* bytes, size_t n_bytes) {
    pthread_once(&is_made, make_table);
    uint32_t rest = ~(uint32_t)before;
    for (; n_bytes >= 8; bytes += 8, n_bytes -= 8) {
        rest ^= (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
                (uint32_t)bytes[3] << 24;
        rest = table[7][rest & 0xff] ^ table[6][rest >> 8 & 0xff] ^ table[5][rest >> 16 & 0xff] ^
               table[4][rest >> 24] ^ table[3][bytes[4]] ^ table[2][bytes[5]] ^ table[1][bytes[6]] ^
               table[0][bytes[7]];
    }
    for (; n_bytes > 0; ++bytes, --n_bytes) {
        rest = table[0][(rest ^ *bytes) & 0xff] ^ (rest >> 8);
    }
    return (int64_t)(uint32_t)~rest;
}
