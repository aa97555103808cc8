#pragma once

#include "schemas/phase/declared.h"
