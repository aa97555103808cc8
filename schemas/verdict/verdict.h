#pragma once

#include "schemas/verdict/declared.h"
