// FORBIDDEN is the header, in its angle brackets.
#include "core/angle.h"
#include FORBIDDEN
