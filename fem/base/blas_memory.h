#pragma once

namespace softfinger::fem {

/// Gives OpenBLAS no threads beside those that call it, and makes it take its working memory, which
/// it keeps. Where memory is short (`ulimit -v`) it would else ask for it in an endless loop, in
/// the middle of the work.
/// @throws InputError when there is not enough
void reserve_blas_memory();

}  // namespace softfinger::fem
