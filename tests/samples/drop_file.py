"""Drops a file onto the only window that takes files on an X display, as a file manager would (XDND version 5).

    drop_file.py PATH...    one after the other; prints the window's title after each

Exit code: 0 every file was asked for by the window, 1 not.
"""
import ctypes
import sys
import time
import urllib.parse

X = ctypes.CDLL("libX11.so.6")
Window = Atom = Time = ctypes.c_ulong


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p),
                ("window", Window), ("message_type", Atom), ("format", ctypes.c_int), ("data", ctypes.c_long * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p),
                ("owner", Window), ("requestor", Window), ("selection", Atom), ("target", Atom), ("property", Atom),
                ("time", Time)]


class Selection(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p),
                ("requestor", Window), ("selection", Atom), ("target", Atom), ("property", Atom), ("time", Time)]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("client", ClientMessage), ("request", SelectionRequest), ("selection", Selection),
                ("pad", ctypes.c_long * 24)]


SELECTION_REQUEST, SELECTION_NOTIFY, CLIENT_MESSAGE = 30, 31, 33
X.XOpenDisplay.restype = ctypes.c_void_p
X.XDefaultRootWindow.restype = X.XInternAtom.restype = X.XCreateSimpleWindow.restype = ctypes.c_ulong
for name, types in {"XInternAtom": [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int], "XDefaultRootWindow": [ctypes.c_void_p],
                    "XCreateSimpleWindow": [ctypes.c_void_p, Window] + 2 * [ctypes.c_int] + 3 * [ctypes.c_uint]
                    + 2 * [ctypes.c_ulong],
                    "XSetSelectionOwner": [ctypes.c_void_p, Atom, Window, Time], "XPending": [ctypes.c_void_p],
                    "XNextEvent": [ctypes.c_void_p, ctypes.c_void_p], "XFlush": [ctypes.c_void_p],
                    "XFree": [ctypes.c_void_p],
                    "XSendEvent": [ctypes.c_void_p, Window, ctypes.c_int, ctypes.c_long, ctypes.c_void_p],
                    "XChangeProperty": [ctypes.c_void_p, Window, Atom, Atom] + 2 * [ctypes.c_int]
                    + [ctypes.c_char_p, ctypes.c_int],
                    "XQueryTree": [ctypes.c_void_p, Window] + 4 * [ctypes.c_void_p],
                    "XGetWindowProperty": [ctypes.c_void_p, Window, Atom] + 2 * [ctypes.c_long] + [ctypes.c_int, Atom]
                    + 5 * [ctypes.c_void_p]}.items():
    getattr(X, name).argtypes = types

display = ctypes.c_void_p(X.XOpenDisplay(None))
root = X.XDefaultRootWindow(display)


def atom(name):
    return X.XInternAtom(display, name.encode(), 0)


def children():
    parent, other, list_, count = Window(), Window(), ctypes.POINTER(Window)(), ctypes.c_uint()
    X.XQueryTree(display, root, ctypes.byref(other), ctypes.byref(parent), ctypes.byref(list_), ctypes.byref(count))
    found = [list_[i] for i in range(count.value)]
    if count.value:
        X.XFree(list_)
    return found


def text_of(window, name):
    kind, format_, count, after, data = Atom(), ctypes.c_int(), ctypes.c_ulong(), ctypes.c_ulong(), ctypes.c_void_p()
    X.XGetWindowProperty(display, window, atom(name), 0, 1024, 0, 0, ctypes.byref(kind), ctypes.byref(format_),
                         ctypes.byref(count), ctypes.byref(after), ctypes.byref(data))
    if not data.value:
        return None
    text = ctypes.string_at(data.value, count.value * max(format_.value // 8, 1))
    X.XFree(data)
    return text


def send(target, name, source, *rest):
    event = Event()
    event.client.type, event.client.window, event.client.format = CLIENT_MESSAGE, target, 32
    event.client.message_type = atom(name)
    event.client.data[:] = [source, *rest]
    X.XSendEvent(display, target, 0, 0, ctypes.byref(event))
    X.XFlush(display)


def answer(request, uri):
    X.XChangeProperty(display, request.requestor, request.property, request.target, 8, 0, uri, len(uri))
    event = Event()
    event.selection.type, event.selection.requestor = SELECTION_NOTIFY, request.requestor
    event.selection.selection, event.selection.target = request.selection, request.target
    event.selection.property, event.selection.time = request.property, request.time
    X.XSendEvent(display, request.requestor, 0, 0, ctypes.byref(event))
    X.XFlush(display)


def drop(target, path):
    source = X.XCreateSimpleWindow(display, root, 0, 0, 1, 1, 0, 0, 0)
    X.XSetSelectionOwner(display, atom("XdndSelection"), source, 0)
    uri_list = atom("text/uri-list")
    send(target, "XdndEnter", source, 5 << 24, uri_list, 0, 0)
    send(target, "XdndPosition", source, 0, (100 << 16) | 100, 0, atom("XdndActionCopy"))
    send(target, "XdndDrop", source, 0, 0, 0, 0)
    end = time.monotonic() + 60
    while time.monotonic() < end:
        while X.XPending(display):
            event = Event()
            X.XNextEvent(display, ctypes.byref(event))
            if event.type == SELECTION_REQUEST:
                answer(event.request, ("file://" + urllib.parse.quote(path) + "\r\n").encode())
            elif event.type == CLIENT_MESSAGE and event.client.message_type == atom("XdndFinished"):
                return True
        time.sleep(0.02)
    return False


def find_target():
    end = time.monotonic() + 60
    while time.monotonic() < end:
        for window in children():
            if text_of(window, "XdndAware") is not None and text_of(window, "_NET_WM_NAME"):
                return window
        time.sleep(0.05)
    sys.exit(1)


target = find_target()
for path in sys.argv[1:]:
    if not drop(target, path):
        sys.exit(1)
    time.sleep(2)  # the file is opened at the start of the next frame
    print(text_of(target, "_NET_WM_NAME").decode(), flush=True)
