!> Contact with Coulomb friction by complementary pivoting: slower than Newton's iteration, but
!! certain to end.
!!
!! In two dimensions unilateral contact with Coulomb friction on a linear body is a linear
!! complementarity problem (Klarbring 1986; Stewart and Trinkle 1996). With the pressure P = -f_n
!! and the shear b+ - b- = -f_tau as nodal forces, the flexibility of the body, and l >= |d[u]_tau|:
!!   [u]_n - tan(psi) l >= 0      and P  >= 0, the product 0
!!    d[u]_tau + l      >= 0      and b+ >= 0, the product 0
!!   -d[u]_tau + l      >= 0      and b- >= 0, the product 0
!!   mu_s P - b+ - b-   >= 0      and l  >= 0, the product 0
!! Its matrix M is copositive where mu_s >= tan(psi): z'Mz is the work of the contact forces on the
!! body plus (mu_s - tan(psi)) P l. So Lemke's algorithm (Lemke 1965; Cottle, Pang and Stone 1992,
!! section 4.4) ends in a solution, for any friction, if the body is held and the total slip before
!! was none. Elsewhere it is without this guarantee:
!! - Rings closed at a joint make the stiffness unsymmetric.
!! - Dilation after a slip: l gives way to |[u]_tau| = t + 2 v with v + t >= 0 and v >= 0, the
!!   product 0, and t the total slip, positive in its direction before.
!! - Joints that close under pressure: [u]_n + P/k_ni is what is not negative, which leaves M
!!   copositive; as they stiffen, and bonds not being there, the result is a start.
!! - Faces held closed with friction: its bound is that of the pressed part P+ of P, so that under
!!   tension the result is a start for the iteration, not its solution.
module contact_pivoting
   use algebra_lapack, only: dgetrf, dgetrs
   use base_kinds, only: ik, rk
   use base_tolerances, only: round_off
   use contact_law, only: contact_law_t
   implicit none(type, external)
   private

   public :: pivot_to_solution, slips_t

   !> What is known of the slip of some points, as stresses.
   type :: slips_t
      logical, allocatable :: is_given(:)
      real(rk), allocatable :: before(:)  !< of the step [Pa]
      real(rk), allocatable :: given(:)  !< where it is [Pa]
   end type slips_t

   !> The dictionary: basic variables as linear functions of the others, all of them >= 0 but for
   !! the free ones. The last two columns are those of the cover z0 and of the constant.
   type :: dictionary_t
      real(rk), allocatable :: entry(:, :)  !< (m, m + 2)
      integer(ik), allocatable :: basic(:)  !< (m) y_k is k, its complement z_k is m + k, z0 2 m + 1
      integer(ik), allocatable :: outside(:)  !< (m + 1) variables that are zero
      logical, allocatable :: is_free(:)  !< (m) of any sign, its y_k zero
   end type dictionary_t

   !> Where the unknowns of a pair are in the dictionary; 0 where it has none.
   type :: places_t
      integer(ik) :: normal = 0  !< P
      integer(ik) :: forward = 0, backward = 0  !< b+, b-
      integer(ik) :: bound = 0  !< l
      integer(ik) :: pressed = 0  !< P+ of faces that cannot part
      integer(ik) :: given = 0  !< shear where the slip is given
      integer(ik) :: reversed = 0  !< v: how far the slip is beyond its sign, for the gap
   end type places_t

contains

   !> Jumps that fulfil the law, up to round-off that may have grown with the number of pivots.
   !! Lengths are scaled out, jumps are multiplied by the law's stiffness: all is stress.
   subroutine pivot_to_solution(stiffness, load, law, compliance, slips, x, is_solved)
      real(rk), intent(in) :: stiffness(:, :)  !< (2 n, 2 n) an equation per column [-]
      real(rk), intent(in) :: load(:)  !< (2 n) n, tau pair by pair [Pa]
      type(contact_law_t), intent(in) :: law(:)  !< (n)
      real(rk), intent(in) :: compliance(:)  !< (n) of the closed faces, at first [-]
      type(slips_t), intent(in) :: slips  !< (n)
      real(rk), intent(inout) :: x(:)  !< (2 n) jumps [Pa]; replaced if solved
      logical, intent(out) :: is_solved
      integer(ik), parameter :: covers = 4  ! tried where a path may end without a solution
      type(dictionary_t) :: dictionary, start
      type(places_t) :: places(size(law))
      real(rk) :: flexibility(size(x), size(x)), force(size(x)), scale
      integer(ik) :: cover, i

      is_solved = .false.
      call invert(stiffness, flexibility, is_solved)
      scale = max(maxval(abs(load)), maxval(abs(slips%before)), maxval(abs(slips%given)))
      if (.not. is_solved .or. .not. scale > 0.0_rk) return
      call place_unknowns(law, slips, places, start)
      call fill(flexibility, load/scale, law, &
                slips_t(slips%is_given, slips%before/scale, slips%given/scale), x, places, start)
      do i = 1, size(law)
         associate (entry => start%entry(places(i)%normal, places(i)%normal))
            entry = entry + compliance(i)
         end associate
      end do
      do cover = 1, covers
         dictionary = start
         call take_cover(cover, dictionary)
         call release_free(dictionary, is_solved)
         if (is_solved) call follow_path(dictionary, is_solved)
         if (is_solved) exit
      end do
      if (.not. is_solved) return
      force = load/scale
      do i = 1, size(law)
         associate (at => places(i))
            force(2*i - 1) = force(2*i - 1) + value_of(dictionary, at%normal)
            force(2*i) = force(2*i) + value_of(dictionary, at%forward) &
                         - value_of(dictionary, at%backward) + value_of(dictionary, at%given)
         end associate
      end do
      x = scale*matmul(flexibility, force)
   end subroutine pivot_to_solution

   !> Jumps by forces.
   subroutine invert(stiffness, flexibility, is_regular)
      real(rk), intent(in) :: stiffness(:, :)  !< (2 n, 2 n) an equation per column [-]
      real(rk), intent(out) :: flexibility(:, :)  !< (2 n, 2 n) jump, force [-]
      logical, intent(out) :: is_regular
      real(rk) :: factors(size(stiffness, 1), size(stiffness, 1))
      integer(ik) :: i, info, n, pivots(size(stiffness, 1))

      n = size(stiffness, 1, kind=ik)
      factors = stiffness
      flexibility = 0.0_rk
      do i = 1, n
         flexibility(i, i) = 1.0_rk
      end do
      call dgetrf(n, n, factors, n, pivots, info)
      is_regular = info == 0
      if (is_regular) call dgetrs("T", n, n, factors, n, pivots, flexibility, n, info)
   end subroutine invert

   !> Number the unknowns.
   pure subroutine place_unknowns(law, slips, places, dictionary)
      type(contact_law_t), intent(in) :: law(:)
      type(slips_t), intent(in) :: slips  !< before the step only whether they are zero counts
      type(places_t), intent(out) :: places(:)
      type(dictionary_t), intent(out) :: dictionary
      integer(ik) :: i, m

      m = 0
      allocate (dictionary%is_free(7*size(law)), source=.false.)
      do i = 1, size(law)
         associate (at => places(i))
            call take(m, at%normal)
            dictionary%is_free(at%normal) = law(i)%bilateral
            if (slips%is_given(i)) then
               call take(m, at%given)
               dictionary%is_free(at%given) = .true.
            else if (law(i)%friction > 0.0_rk) then
               call take(m, at%forward)
               call take(m, at%backward)
               call take(m, at%bound)
               if (law(i)%bilateral) call take(m, at%pressed)
            end if
            if (.not. slips%is_given(i) .and. law(i)%dilation > 0.0_rk .and. &
                (at%bound == 0 .or. abs(slips%before(i)) > 0.0_rk)) call take(m, at%reversed)
         end associate
      end do
      dictionary%is_free = dictionary%is_free(:m)
      allocate (dictionary%entry(m, m + 2), source=0.0_rk)
      dictionary%basic = [(i, i=1, m)]
      dictionary%outside = [(m + i, i=1, m + 1)]

   contains

      pure subroutine take(count, place)
         integer(ik), intent(inout) :: count
         integer(ik), intent(out) :: place

         count = count + 1
         place = count
      end subroutine take

   end subroutine place_unknowns

   !> The equations.
   pure subroutine fill(flexibility, load, law, slips, x, places, dictionary)
      real(rk), intent(in) :: flexibility(:, :)  !< (2 n, 2 n) jump, force [-]
      real(rk), intent(in) :: load(:)  !< (2 n) over the largest of all loads and jumps [-]
      type(contact_law_t), intent(in) :: law(:)
      type(slips_t), intent(in) :: slips  !< (n) over that scale [-]
      real(rk), intent(in) :: x(:)  !< (2 n) the last jumps [Pa]; their signs count
      type(places_t), intent(in) :: places(:)
      type(dictionary_t), intent(inout) :: dictionary
      real(rk) :: motion(size(load)), side, slope
      integer(ik) :: constant, i, m

      m = size(dictionary%basic, kind=ik)
      constant = m + 2
      motion = matmul(flexibility, load)
      associate (entry => dictionary%entry)
         do i = 1, size(law)
            associate (at => places(i))
               slope = law(i)%dilation
               call add_motion(flexibility, motion, places, at%normal, 2*i - 1, 1.0_rk, entry)
               if (slips%is_given(i)) then
                  call add_motion(flexibility, motion, places, at%given, 2*i, 1.0_rk, entry)
                  associate (slip => entry(at%given, constant), opens => entry(at%normal, constant))
                     slip = slip - slips%given(i)
                     opens = opens - slope*abs(slips%given(i))
                  end associate
                  cycle
               end if
               if (at%reversed > 0) then
                  side = sign(1.0_rk, merge(slips%before(i), x(2*i), abs(slips%before(i)) > 0.0_rk))
                  call add_motion(flexibility, motion, places, at%normal, 2*i, -slope*side, entry)
                  entry(at%normal, at%reversed) = -2.0_rk*slope
                  call add_motion(flexibility, motion, places, at%reversed, 2*i, side, entry)
                  entry(at%reversed, at%reversed) = 1.0_rk
               else if (at%bound > 0) then
                  entry(at%normal, at%bound) = -slope
               end if
               if (at%bound == 0) cycle
               call add_motion(flexibility, motion, places, at%forward, 2*i, 1.0_rk, entry)
               call add_motion(flexibility, motion, places, at%backward, 2*i, -1.0_rk, entry)
               entry(at%forward, constant) = entry(at%forward, constant) - slips%before(i)
               entry(at%backward, constant) = entry(at%backward, constant) + slips%before(i)
               entry([at%forward, at%backward], at%bound) = 1.0_rk
               entry(at%bound, [at%forward, at%backward]) = -1.0_rk
               if (at%pressed > 0) then
                  entry(at%bound, at%pressed) = law(i)%friction
                  entry(at%pressed, at%pressed) = 1.0_rk
                  entry(at%pressed, at%normal) = -1.0_rk
               else
                  entry(at%bound, at%normal) = law(i)%friction
               end if
            end associate
         end do
      end associate
   end subroutine fill

   !> Add a component of the jumps, as a function of the forces, to an equation.
   pure subroutine add_motion(flexibility, motion, places, row, component, factor, entry)
      real(rk), intent(in) :: flexibility(:, :)  !< (2 n, 2 n) jump, force [-]
      real(rk), intent(in) :: motion(:)  !< (2 n) jumps by the load [-]
      type(places_t), intent(in) :: places(:)
      integer(ik), intent(in) :: row, component
      real(rk), intent(in) :: factor  !< [-]
      real(rk), intent(inout) :: entry(:, :)  !< of the dictionary [-]
      integer(ik) :: constant, j

      constant = size(entry, 2, kind=ik)
      entry(row, constant) = entry(row, constant) + factor*motion(component)
      do j = 1, size(places)
         associate (at => places(j), by_normal => flexibility(component, 2*j - 1), &
                    by_shear => flexibility(component, 2*j))
            entry(row, at%normal) = entry(row, at%normal) + factor*by_normal
            if (at%given > 0) then
               entry(row, at%given) = entry(row, at%given) + factor*by_shear
            else if (at%bound > 0) then
               entry(row, at%forward) = entry(row, at%forward) + factor*by_shear
               entry(row, at%backward) = entry(row, at%backward) - factor*by_shear
            end if
         end associate
      end do
   end subroutine add_motion

   !> The shares of the cover, between 1 and 2. No two are equal (Weyl's irregular numbers), so that
   !! ties on the path are accidents of round-off.
   pure subroutine take_cover(number, dictionary)
      integer(ik), intent(in) :: number
      type(dictionary_t), intent(inout) :: dictionary
      real(rk), parameter :: golden = 0.6180339887498949_rk
      real(rk) :: multiple
      integer(ik) :: k, m

      m = size(dictionary%basic, kind=ik)
      do k = 1, m
         multiple = golden*k*number**2
         if (.not. dictionary%is_free(k)) dictionary%entry(k, m + 1) = 1.0_rk + multiple &
                                                                       - aint(multiple)
      end do
   end subroutine take_cover

   !> Make the free unknowns basic, once and for all.
   pure subroutine release_free(dictionary, is_done)
      type(dictionary_t), intent(inout) :: dictionary
      logical, intent(out) :: is_done
      integer(ik) :: k

      is_done = .true.
      do k = 1, size(dictionary%basic)
         if (.not. dictionary%is_free(k)) cycle
         is_done = abs(dictionary%entry(k, k)) > tiny(1.0_rk)
         if (.not. is_done) return
         call exchange(dictionary, k, k)
      end do
   end subroutine release_free

   !> Lemke's path: enough of the cover makes everything feasible; then the complement of what has
   !! left the basis enters, until the cover leaves or is no more than round-off.
   pure subroutine follow_path(dictionary, is_done)
      type(dictionary_t), intent(inout) :: dictionary
      logical, intent(out) :: is_done
      real(rk), parameter :: infeasible = 1.0e-13_rk  ! of the largest constant
      real(rk), parameter :: used_up = 1.0e-13_rk  ! of the cover at the start
      real(rk) :: none
      integer(ik) :: cover, entering, leaving, m, pivot, row

      m = size(dictionary%basic, kind=ik)
      cover = 2*m + 1
      associate (entry => dictionary%entry)
         row = 0
         do pivot = 1, m
            if (dictionary%is_free(pivot)) cycle
            if (row == 0) row = pivot
            if (entry(pivot, m + 2)*entry(row, m + 1) < entry(row, m + 2)*entry(pivot, m + 1)) then
               row = pivot
            end if
         end do
         is_done = row == 0
         if (.not. is_done) is_done = entry(row, m + 2) >= -infeasible*maxval(abs(entry(:, m + 2)))
      end associate
      if (is_done) return
      leaving = dictionary%basic(row)
      call exchange(dictionary, row, m + 1)
      none = used_up*dictionary%entry(row, m + 2)
      do pivot = 1, 50*m
         entering = merge(leaving + m, leaving - m, leaving <= m)
         entering = findloc(dictionary%outside, entering, dim=1)
         call find_leaving(dictionary, entering, row)
         if (row == 0) return
         leaving = dictionary%basic(row)
         call exchange(dictionary, row, entering)
         is_done = leaving == cover
         if (is_done) return
         is_done = dictionary%entry(findloc(dictionary%basic, cover, dim=1), m + 2) <= none
         if (is_done) return
      end do
   end subroutine follow_path

   !> The basic variable that becomes zero first as a variable enters; of equals the cover, else the
   !! one with the largest pivot. 0: none does.
   pure subroutine find_leaving(dictionary, entering, row)
      type(dictionary_t), intent(in) :: dictionary
      integer(ik), intent(in) :: entering
      integer(ik), intent(out) :: row
      real(rk) :: smallest, steepness, value
      integer(ik) :: cover, i, m

      m = size(dictionary%basic, kind=ik)
      cover = 2*m + 1
      row = 0
      smallest = huge(1.0_rk)
      associate (column => dictionary%entry(:, entering), constant => dictionary%entry(:, m + 2))
         steepness = round_off*maxval(abs(column))
         do i = 1, m
            if (is_bound(i)) smallest = min(smallest, max(0.0_rk, constant(i))/(-column(i)))
         end do
         do i = 1, m
            if (.not. is_bound(i)) cycle
            value = max(0.0_rk, constant(i))/(-column(i))
            if (value > smallest + round_off*max(1.0_rk, smallest)) cycle
            if (row == 0) row = i
            if (dictionary%basic(row) == cover) exit
            if (dictionary%basic(i) == cover .or. column(i) < column(row)) row = i
         end do
      end associate

   contains

      !> The variable falls with the entering one, and must not become negative.
      pure logical function is_bound(i)
         integer(ik), intent(in) :: i

         is_bound = dictionary%entry(i, entering) < -steepness
         if (.not. is_bound .or. dictionary%basic(i) <= m .or. dictionary%basic(i) == cover) return
         is_bound = .not. dictionary%is_free(dictionary%basic(i) - m)
      end function is_bound

   end subroutine find_leaving

   !> A basic variable and one outside change places.
   pure subroutine exchange(dictionary, row, column)
      type(dictionary_t), intent(inout) :: dictionary
      integer(ik), intent(in) :: row, column
      real(rk) :: entering(size(dictionary%basic)), share
      integer(ik) :: j, variable

      associate (entry => dictionary%entry)
         entering = entry(:, column)
         do j = 1, size(entry, 2)
            if (j == column) cycle
            share = -entry(row, j)/entering(row)
            if (.not. abs(share) > 0.0_rk) cycle
            entry(:, j) = entry(:, j) + share*entering
            entry(row, j) = share
         end do
         entry(:, column) = entering/entering(row)
         entry(row, column) = 1.0_rk/entering(row)
      end associate
      variable = dictionary%basic(row)
      dictionary%basic(row) = dictionary%outside(column)
      dictionary%outside(column) = variable
   end subroutine exchange

   !> The value of z_k; 0 if there is none.
   pure real(rk) function value_of(dictionary, k)
      type(dictionary_t), intent(in) :: dictionary
      integer(ik), intent(in) :: k
      integer(ik) :: row

      value_of = 0.0_rk
      if (k == 0) return
      row = findloc(dictionary%basic, k + size(dictionary%basic, kind=ik), dim=1)
      if (row > 0) value_of = dictionary%entry(row, size(dictionary%entry, 2))
   end function value_of

end module contact_pivoting
