"""Presses a key in the only window of an X display, and saves pictures of the screen before and after it.

Usage: press_key.py KEYSYM BEFORE.png AFTER.png
"""
import ctypes
import sys
import time

from PIL import ImageGrab

X = ctypes.CDLL("libX11.so.6")
Window = ctypes.c_ulong


class Key(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p),
                ("window", Window), ("root", Window), ("subwindow", Window), ("time", ctypes.c_ulong), ("x", ctypes.c_int),
                ("y", ctypes.c_int), ("x_root", ctypes.c_int), ("y_root", ctypes.c_int), ("state", ctypes.c_uint),
                ("keycode", ctypes.c_uint), ("same_screen", ctypes.c_int), ("pad", ctypes.c_long * 12)]


X.XOpenDisplay.restype = ctypes.c_void_p
X.XDefaultRootWindow.restype, X.XDefaultRootWindow.argtypes = Window, [ctypes.c_void_p]
X.XKeysymToKeycode.restype, X.XKeysymToKeycode.argtypes = ctypes.c_ubyte, [ctypes.c_void_p, ctypes.c_ulong]
X.XStringToKeysym.restype = ctypes.c_ulong
X.XQueryTree.argtypes = [ctypes.c_void_p, Window] + 4 * [ctypes.c_void_p]
X.XSendEvent.argtypes = [ctypes.c_void_p, Window, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
X.XFlush.argtypes = [ctypes.c_void_p]
PRESS, RELEASE = 2, 3
display = ctypes.c_void_p(X.XOpenDisplay(None))
root = X.XDefaultRootWindow(display)


def windows():
    parent, other, found, count = Window(), Window(), ctypes.POINTER(Window)(), ctypes.c_uint()
    X.XQueryTree(display, root, ctypes.byref(other), ctypes.byref(parent), ctypes.byref(found), ctypes.byref(count))
    return [found[i] for i in range(count.value)]


def shown():
    """The screen as soon as something is drawn: not one colour."""
    picture = ImageGrab.grab(xdisplay="")
    return picture if len(picture.getcolors(1 << 24)) > 500 else None


def wait_for(condition, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.2)
    sys.exit("nothing is drawn")


key = X.XKeysymToKeycode(display, X.XStringToKeysym(sys.argv[1].encode()))
before = wait_for(shown)
before.save(sys.argv[2])
for window in windows():
    for kind in (PRESS, RELEASE):
        event = Key(type=kind, display=display, window=window, root=root, keycode=key, same_screen=1)
        X.XSendEvent(display, window, 1, 1 if kind == PRESS else 2, ctypes.byref(event))
        X.XFlush(display)
        time.sleep(1.5)  # a frame between press and release, or a slow machine never sees the key down
time.sleep(1.5)
wait_for(shown).save(sys.argv[3])
