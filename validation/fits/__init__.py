"""What measured curves say about material and adhesion: curves, parameters, fits and their errors.

One of the kinds of evidence that stand beside each other: runs compared with an instrument's record
instead of another solver's run. From the bottom up, each module knows only those before it:

``contact``: the contact point of an approach; ``features``: what a record shows without a solver;
``record``: a curve, its signs, segments, and the above as its methods; ``readers``: files of curves;
``curve_page``: the table and picture of what a record shows.

``model``: when contact begins and ends, noise, the motion as straight lines, and what a run of the scene
leaves of a record; ``parameters``: settings, and the numbers of a search; ``result``: errors and goodness of
a point; ``problem``: residuals and derivatives by single runs or in batches, the search, profiles;
``data_checks``: refusals and warnings beforehand; ``posterior``; ``fit``: all of it in order, the second
solver, many curves; ``page``: what is written. ``synthetic``: curves as an instrument would record them.
"""
