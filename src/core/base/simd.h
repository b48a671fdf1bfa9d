#include "projdyn/simd.h"
