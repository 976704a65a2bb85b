"""The browser app: draws what the functions below it answer, and computes no physics.

``command.view`` is the door. A room stands on those before it:

    guard, server      a page on this machine alone, whatever another site's page tries
    editing, uploads   a design with one thing changed, or from a file that a page hands over; no browser in it
    answers, words     what is asked of the functions below, and its text
    picture            the bodies of the scene as viser shows them
    player             what turns, by the clock: constant speeds or a run
    study, board       results of many machines, and the plot in which one is chosen
    panels/            sliders, buttons and text, a tab a file
    inbox, session     one page: what was changed, and what follows from it, on one thread
"""
