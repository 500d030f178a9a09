#pragma once

namespace softfinger::fem {

/// Makes OpenBLAS take its working memory, which it keeps. Where memory is short (`ulimit -v`) it
/// would else ask for it in an endless loop, in the middle of the work.
/// @throws InputError when there is not enough
void reserve_blas_memory();

}  // namespace softfinger::fem
