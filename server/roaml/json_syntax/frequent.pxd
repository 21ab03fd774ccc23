# SPDX-License-Identifier: Apache-2.0
# The C types of frequent.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython

cdef Py_ssize_t _MAX_DIGITS

@cython.locals(
    here=Py_ssize_t, character=Py_UCS4, name_start=Py_ssize_t, name_end=Py_ssize_t, colon=Py_ssize_t, name=str
)
cpdef tuple read_frequent(
    str text, Py_ssize_t at, list stack, Py_ssize_t start, bint is_object, list parts, dict words
)

cdef bint is_waiting(object key)

cdef object closed(Py_ssize_t start, Py_ssize_t end, bint is_object, list parts)

@cython.locals(character=Py_UCS4, end=Py_ssize_t, first=Py_ssize_t, run=str, word=str)
cdef object atom(str text, Py_ssize_t start, bint is_item, dict words)

@cython.locals(first=Py_ssize_t, end=Py_ssize_t, is_real=bint, written=str)
cdef object number(str text, Py_ssize_t start)

@cython.locals(end=Py_ssize_t, content=str)
cdef Py_ssize_t end_of_string(str text, Py_ssize_t start)

@cython.locals(character=Py_UCS4)
cdef Py_ssize_t past_digits(str text, Py_ssize_t at)

@cython.locals(character=Py_UCS4)
cdef Py_ssize_t past_space(str text, Py_ssize_t at)

cdef bint ends_word(Py_UCS4 character)
