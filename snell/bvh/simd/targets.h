// Which instruction sets the traversal is compiled for; read before <hwy/foreach_target.h>. SSE4 (the least that snell
// runs on), AVX2 and AVX-512 on x86; elsewhere what Highway finds. The AVX-512 dialects beyond the first have nothing
// for us.
#pragma once

#define HWY_DISABLE_PCLMUL_AES
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// A minute of compiling saved for each kind of node; what is special to AVX2 is a few lines.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_AVX2)
#else
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#endif
