#pragma once

#include "schemas/screened_phase/declared.h"
