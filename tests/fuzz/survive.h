/* survive.h - what the fuzz targets share; each begins with if (setjmp(refused)) return
 * 0; */
#ifndef SURVIVE_H
#define SURVIVE_H

#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>

extern jmp_buf refused;

/* Path of a file with these bytes, overwritten by the next call. */
const char *stream_of(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
