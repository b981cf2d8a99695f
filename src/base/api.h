// FROUDE_API marks what a shared library of Froude shows to the outside. All else is built hidden.
#pragma once

#define FROUDE_API __attribute__((visibility("default")))
