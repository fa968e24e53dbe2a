// Which instruction sets the traversal is compiled for; read before <hwy/foreach_target.h>. SSE4 (the least that snell
// runs on), AVX2 and AVX-512 on x86; elsewhere what Highway finds. The AVX-512 dialects beyond the first have nothing
// for us.
#pragma once

#define HWY_DISABLE_PCLMUL_AES
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
